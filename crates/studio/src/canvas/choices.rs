//! The search for an action to which a key is bound.

use ademan_core::device::KeyCode;

/// Returns the keys that match a query, the best first: by name, label or alias, as `ademan layout keys` lists them.
pub fn matching_keys(query: &str) -> Vec<KeyCode> {
    let query = query.trim().to_lowercase();
    let ranked = KeyCode::all().filter_map(|code| Some((rank(code, &query)?, code)));
    let mut ranked: Vec<_> = ranked.collect();
    ranked.sort_by_key(|(rank, code)| (*rank, code.event_code()));
    ranked.into_iter().map(|(_, code)| code).collect()
}

/// Returns 0 for a name that equals the query, 1 for one that begins with it, 2 for one that contains it.
fn rank(code: KeyCode, query: &str) -> Option<u8> {
    let names = [code.name(), code.label()].into_iter();
    let names = names.chain(code.aliases().iter().copied());
    names
        .filter_map(|name| {
            let name = name.to_lowercase();
            match name.find(query) {
                Some(0) if name.len() == query.len() => Some(0),
                Some(0) => Some(1),
                Some(_) => Some(2),
                None => None,
            }
        })
        .min()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(query: &str) -> &'static str {
        matching_keys(query).first().map_or("", |code| code.name())
    }

    #[test]
    fn the_best_match_comes_first() {
        for (query, expected) in [
            ("q", "Q"),
            ("esc", "Escape"),
            ("ctrl", "ControlLeft"),
            (" return ", "Enter"),
            (";", "Semicolon"),
            ("mouse", "MouseLeft"),
        ] {
            assert_eq!(first(query), expected, "{query}");
        }
    }

    #[test]
    fn an_empty_query_lists_every_key_and_nonsense_none() {
        assert_eq!(matching_keys("").len(), KeyCode::all().count());
        assert!(matching_keys("no such key").is_empty());
    }
}
