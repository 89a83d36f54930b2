//! The score of a layout on the page, with a map of missed keys.

use serde_json::json;

use super::browser_and_server;
use super::page::{edit, look_like, open};

const LOOK: &str = r##"({
  text: document.getElementById("score-text").textContent,
  button: document.getElementById("score-start").textContent,
  is_running: !document.getElementById("score-progress").hidden,
  heated: document.querySelectorAll("#plan .is-heated").length,
  fills: new Set([...document.querySelectorAll("#plan .is-heated :is(rect, ellipse)")].map((it) => getComputedStyle(it).fill)).size,
  described: document.querySelector('#plan [data-name="E"]')?.getAttribute("aria-description"),
  worst: document.querySelectorAll("#score-keys li").length,
  slowest: globalThis.slowest,
  overflow: document.documentElement.scrollWidth - innerWidth,
})"##;

/// Measures the longest time between two pictures from now on.
const WATCH: &str = r##"(() => {
  globalThis.slowest = 0;
  let last = performance.now();
  const frame = (now) => {
    globalThis.slowest = Math.max(globalThis.slowest, now - last);
    last = now;
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
})()"##;

/// Keeps the workers that start from now on.
const KEEP_WORKERS: &str = r##"(() => {
  globalThis.workers = [];
  globalThis.Worker = class extends Worker {
    constructor(...args) {
      super(...args);
      workers.push(this);
    }
  };
})()"##;

/// Keeps the page after the first person whose score colors some keys: on a busy machine all people may have typed before the next look.
const KEEP_FIRST_SCORE: &str = r##"(() => {
  globalThis.firstScore = null;
  const text = document.getElementById("score-text");
  new MutationObserver(() => {
    if (firstScore || document.querySelectorAll("#plan .is-heated").length <= 5) return;
    globalThis.firstScore = {
      button: document.getElementById("score-start").textContent,
      is_running: !document.getElementById("score-progress").hidden,
    };
  }).observe(text, { childList: true });
})()"##;

#[test]
fn people_score_a_layout_beside_the_page_and_the_plan_shows_missed_keys() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    browser.evaluate("document.getElementById('score').open = true");
    browser.evaluate(WATCH);
    browser.evaluate(KEEP_WORKERS);
    browser.evaluate(KEEP_FIRST_SCORE);
    browser.evaluate("document.getElementById('score-start').click()");
    let first = browser.wait_for("({firstScore})", "the first person has typed", |look| {
        look["firstScore"].is_object()
    });
    assert_eq!(
        first["firstScore"],
        json!({"button": "Stop", "is_running": true})
    );
    // The page continues: the simulated hand types.
    browser.evaluate("document.getElementById('type').click()");
    browser.wait_for(
        "({typed: document.getElementById('typed').value})",
        "the hand types",
        |look| look["typed"] == "hello",
    );
    let done = browser.wait_for(LOOK, "all people have typed", |look| {
        look["is_running"] == false
    });
    let text = done["text"].as_str().expect("a text");
    assert!(
        text.starts_with("8 simulated people: ") && text.contains("words a minute"),
        "{text}"
    );
    assert!(done["fills"].as_u64() > Some(2), "keys differ: {done}");
    assert!(
        done["described"]
            .as_str()
            .is_some_and(|it| it.contains("strokes miss it")),
        "{done}"
    );
    // A busy machine may need any time.
    println!("longest time between two pictures: {} ms", done["slowest"]);
    for (width, height) in [(1400, 1000), (390, 844)] {
        for theme in ["dark", "light"] {
            look_like(&mut browser, width, height, theme);
            browser.evaluate("document.querySelector('.plan-panel').scrollIntoView()");
            browser.save_picture(&format!("web-score-{width}-{theme}.png"));
            assert_eq!(browser.evaluate(LOOK)["overflow"], 0);
        }
    }

    // Another layout has another score; one with faults has none.
    edit(&mut browser, "it.value.replace('keys:', 'kyes:')");
    browser.evaluate("document.getElementById('score-start').click()");
    let refused = browser.wait_for(LOOK, "a fault", |look| {
        look["text"].as_str().is_some_and(|it| it.contains("kyes"))
    });
    assert_eq!(
        (&refused["heated"], &refused["is_running"]),
        (&json!(0), &json!(false))
    );

    // A message of a worker that was ended may still wait.
    browser
        .evaluate("workers[0].dispatchEvent(new MessageEvent('message', {data: {error: 'late'}}))");
    assert_eq!(browser.evaluate(LOOK)["text"], refused["text"]);
}
