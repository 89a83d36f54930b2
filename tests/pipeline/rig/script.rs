//! Scripts as steps, orders and words.

/// Orders that are carried out at the same time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step<'a> {
    /// The step as written.
    pub text: &'a str,
    /// The words of each order, without quotes; at least one word each.
    pub orders: Vec<Vec<&'a str>>,
}

/// Splits a script into its steps; empty steps and comments are left out.
pub fn steps(script: &str) -> Vec<Step<'_>> {
    let mut steps = Vec::new();
    let mut start = 0;
    while start < script.len() {
        let end = start + step_length(&script[start..]);
        let text = without_comment(&script[start..end]).trim();
        if !text.is_empty() {
            let orders = orders(text);
            steps.push(Step { text, orders });
        }
        start = end + 1;
    }
    steps
}

/// The number of bytes before the `;` or the end of the line that ends a step.
fn step_length(text: &str) -> usize {
    let mut quote = None;
    let mut is_comment = false;
    for (at, character) in text.char_indices() {
        match (character, quote) {
            ('\n', _) => return at,
            (';', None) if !is_comment => return at,
            ('#', None) => {
                is_comment |= text[..at]
                    .chars()
                    .next_back()
                    .is_none_or(char::is_whitespace)
            }
            ('\'' | '"', None) if !is_comment => quote = Some(character),
            (_, Some(open)) if open == character => quote = None,
            _ => {}
        }
    }
    text.len()
}

fn without_comment(text: &str) -> &str {
    let is_start = |at: usize| {
        text[..at]
            .chars()
            .next_back()
            .is_none_or(char::is_whitespace)
    };
    let comment = text.match_indices('#').find(|(at, _)| is_start(*at));
    comment.map_or(text, |(at, _)| &text[..at])
}

fn orders(step: &str) -> Vec<Vec<&str>> {
    let mut orders = vec![Vec::new()];
    let mut rest = step.trim_start();
    while let Some(first) = rest.chars().next() {
        let (word, length) = match first {
            '\'' | '"' => {
                let end = rest[1..].find(first).expect("a name has a closing quote");
                (Some(&rest[1..=end]), end + 2)
            }
            '&' => (None, 1),
            _ => {
                let end = rest.find(|c: char| c.is_whitespace() || c == '&');
                let end = end.unwrap_or(rest.len());
                (Some(&rest[..end]), end)
            }
        };
        match word {
            Some(word) => orders.last_mut().expect("never empty").push(word),
            None => orders.push(Vec::new()),
        }
        rest = rest[length..].trim_start();
    }
    assert!(
        orders.iter().all(|order| !order.is_empty()),
        "an order is missing beside a `&` in `{step}`"
    );
    orders
}

#[test]
fn steps_end_with_a_line_or_a_semicolon_and_comments_are_left_out() {
    let script = "tap Q ; lift;;\n# all of this; is nothing\n\twait 5 # so is this\nindex 'A; B' up & trust ring";
    let texts: Vec<&str> = steps(script).iter().map(|step| step.text).collect();
    assert_eq!(
        texts,
        ["tap Q", "lift", "wait 5", "index 'A; B' up & trust ring"]
    );
    let last = steps(script).pop().expect("a step");
    assert_eq!(
        last.orders,
        [vec!["index", "A; B", "up"], vec!["trust", "ring"]]
    );
}
