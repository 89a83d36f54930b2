//! The files of the viewer, which come with the program, and answers of HTTP.

/// Headers of every answer. The page loads nothing from elsewhere, runs no code but its own, and no other page may show it.
const HEADERS: &str = "Connection: close\r\n\
    Cache-Control: no-store\r\n\
    Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src data:; connect-src 'self'; \
    base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\
    Cross-Origin-Opener-Policy: same-origin\r\n\
    Cross-Origin-Resource-Policy: same-origin\r\n\
    Referrer-Policy: no-referrer\r\n\
    X-Content-Type-Options: nosniff\r\n";

const HTML: &str = "text/html";
const CSS: &str = "text/css";
const SCRIPT: &str = "text/javascript";

/// A file: its path, its type and its text.
const FILES: [(&str, &str, &str); 10] = [
    ("/", HTML, include_str!("viewer/index.html")),
    ("/viewer.css", CSS, include_str!("viewer/viewer.css")),
    ("/boards.js", SCRIPT, include_str!("viewer/boards.js")),
    ("/camera.js", SCRIPT, include_str!("viewer/camera.js")),
    ("/hands.js", SCRIPT, include_str!("viewer/hands.js")),
    ("/painting.js", SCRIPT, include_str!("viewer/painting.js")),
    ("/session.js", SCRIPT, include_str!("viewer/session.js")),
    ("/vectors.js", SCRIPT, include_str!("viewer/vectors.js")),
    ("/view.js", SCRIPT, include_str!("viewer/view.js")),
    ("/viewer.js", SCRIPT, include_str!("viewer/viewer.js")),
];

/// Returns the answer with the file of a path; `None` if there is no such file.
pub(super) fn file(path: &str) -> Option<Vec<u8>> {
    let (_, kind, text) = FILES.iter().find(|(name, ..)| *name == path)?;
    Some(answer("200 OK", kind, text))
}

/// Returns the answer to a request that is refused.
pub(super) fn refusal(status: &str, reason: &str) -> Vec<u8> {
    answer(status, "text/plain", &format!("{reason}\n"))
}

/// Headers of an answer with a file of a folder. Its page may compile WebAssembly, keep files for the time without a network, and
/// read precise times.
const FOLDER_HEADERS: &str = "Connection: close\r\n\
    Cache-Control: no-cache\r\n\
    Content-Security-Policy: default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data:; \
    connect-src 'self'; worker-src 'self'; manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\
    Cross-Origin-Embedder-Policy: require-corp\r\n\
    Cross-Origin-Opener-Policy: same-origin\r\n\
    Cross-Origin-Resource-Policy: same-origin\r\n\
    Referrer-Policy: no-referrer\r\n\
    X-Content-Type-Options: nosniff\r\n";

/// Returns the answer with a file of a folder.
pub(super) fn answer_of_folder(kind: &str, body: &[u8]) -> Vec<u8> {
    let length = body.len();
    let head = format!(
        "HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\n{FOLDER_HEADERS}\r\n"
    );
    [head.as_bytes(), body].concat()
}

fn answer(status: &str, kind: &str, body: &str) -> Vec<u8> {
    let length = body.len();
    format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {length}\r\n{HEADERS}\r\n{body}"
    )
    .into_bytes()
}
