//! Drawings as one HTML file, with a choice of layers.

use std::fmt::Write;

use super::svg::{Part, TooManyShapes};
use super::wearer::Wearer;
use crate::layout::model::Layout;
use crate::message::escape_markup;

/// The style of the page. The colors of the drawings are in the style sheet that follows.
const STYLE: &str = "\
:root{color-scheme:light dark}
body{margin:1.5rem auto;padding:0 1rem;max-width:70rem;font:1rem/1.45 sans-serif;background:$ground;color:$ink}
h1{margin:0}h2{margin:1.6rem 0 .6rem;font-size:1.15rem}
p{margin:.3rem 0}figure{margin:.8rem 0}
svg{max-width:100%;height:auto}
fieldset{display:flex;flex-wrap:wrap;gap:.3rem 1.2rem;border:1px solid $edge;border-radius:.5rem;width:fit-content}
label{cursor:pointer}input:focus-visible{outline:3px solid $accent;outline-offset:2px}
table{border-collapse:collapse}td,th{padding:.15rem 1.2rem .15rem 0;text-align:left;vertical-align:top;font-weight:normal}
td{color:$muted}
.in-layer{display:none}
body:not(:has(#reach:checked)) .reach,body:not(:has(#reach:checked)) .reach-edge,body:not(:has(#reach:checked)) .out{display:none}
";

impl Layout {
    /// Returns one HTML file without references to others: the boards in each layer, chosen with the mouse or the keyboard,
    /// the views in space, and the lists. Light or dark as the reader prefers.
    pub fn to_html(&self, wearer: &Wearer) -> Result<String, TooManyShapes> {
        let parts = super::svg::parts(self, wearer)?;
        let mut page = String::new();
        self.write_html(&parts, &mut page)
            .expect("writing to a string does not fail");
        Ok(page)
    }

    fn write_html(&self, parts: &[Part], page: &mut String) -> std::fmt::Result {
        let name = escape_markup(&self.name);
        let style = super::svg::colored(STYLE) + &self.layer_rules();
        writeln!(
            page,
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width\"/>\n<title>{name}</title>\n\
             <style>\n{style}{}</style>\n</head>\n<body>\n<h1>{name}</h1>\n<p>{}</p>",
            super::svg::sheet(),
            escape_markup(&self.description)
        )?;
        self.write_choices(page)?;
        for part in parts {
            match part {
                Part::Drawing {
                    heading,
                    layer,
                    svg,
                } => {
                    let class = layer.map(|layer| format!(" class=\"in-layer layer-{layer}\""));
                    writeln!(page, "<figure{}>", class.unwrap_or_default())?;
                    if let Some(heading) = heading {
                        writeln!(page, "<h2>{heading}</h2>")?;
                    }
                    writeln!(page, "{svg}</figure>")?;
                }
                Part::List { heading, rows } => {
                    writeln!(page, "<h2>{heading}</h2>\n<table>")?;
                    for (row_name, description) in rows {
                        let (row_name, description) =
                            (escape_markup(row_name), escape_markup(description));
                        writeln!(
                            page,
                            "<tr><th scope=\"row\">{row_name}</th><td>{description}</td></tr>"
                        )?;
                    }
                    writeln!(page, "</table>")?;
                }
            }
        }
        writeln!(page, "</body>\n</html>")
    }

    /// Returns the rules that show the boards of the chosen layer.
    fn layer_rules(&self) -> String {
        let rule =
            |layer| format!("body:has(#layer-{layer}:checked) .layer-{layer}{{display:block}}\n");
        (0..self.layers.len()).map(rule).collect()
    }

    fn write_choices(&self, page: &mut String) -> std::fmt::Result {
        if self.boards.is_empty() {
            return Ok(());
        }
        writeln!(page, "<fieldset><legend>Layer</legend>")?;
        for (layer, name) in self.layers.iter().enumerate() {
            let checked = if layer == 0 { " checked=\"\"" } else { "" };
            writeln!(
                page,
                "<label><input type=\"radio\" name=\"layer\" id=\"layer-{layer}\"{checked}/> {}</label>",
                escape_markup(name)
            )?;
        }
        writeln!(
            page,
            "</fieldset>\n<p><label><input type=\"checkbox\" id=\"reach\" checked=\"\"/> Reach of the hand</label></p>"
        )
    }
}
