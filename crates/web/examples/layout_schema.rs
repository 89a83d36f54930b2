//! Prints the JSON Schema of layout files in one line, for the editor of the page.

use ademan_core::document::json_schema;
use ademan_core::layout::field_tables;

fn main() {
    println!("{}", json_schema(&field_tables()));
}
