//! All layouts that come with the program.

use ademan::document::shipped_layouts;

use crate::picture;
use crate::window::Opening;

#[test]
fn every_shipped_layout_is_drawn() {
    for layout in shipped_layouts() {
        let mut window = Opening::on_layout(layout).open();
        if picture::draw(&mut window, &format!("layout-{layout}")).is_none() {
            return;
        }
    }
}
