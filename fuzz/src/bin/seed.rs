//! Writes the initial corpus, made of shipped files, to `corpus/`.

use std::fs;
use std::path::Path;

use ademan_fuzz::{lines, motion, network, packets, recordings, secure, seeds};

fn main() -> std::io::Result<()> {
    let all = [
        ("packets", packets::seeds()),
        ("lines", lines::seeds()),
        ("bvh", motion::bvh_seeds()),
        ("markers", motion::marker_seeds()),
        ("layouts", seeds::layouts()),
        ("setups", seeds::setups()),
        ("gloves", seeds::gloves()),
        ("marks", seeds::marks()),
        ("arms", seeds::arms()),
        ("persons", seeds::persons()),
        ("recordings", recordings::seeds()),
        ("messages", recordings::message_seeds()),
        ("requests", seeds::requests()),
        ("sources", seeds::sources()),
        ("links", seeds::links()),
        ("scripts", seeds::scripts()),
        ("share", network::share_seeds()),
        ("datagrams", network::message_seeds()),
        ("tokens", secure::token_seeds()),
        ("handshake", secure::handshake_seeds()),
        ("pipeline", seeds::pipeline()),
    ];
    for (target, inputs) in all {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("corpus")
            .join(target);
        fs::create_dir_all(&folder)?;
        for (number, input) in inputs.iter().enumerate() {
            fs::write(folder.join(format!("seed-{number}")), input)?;
        }
        println!("{}: {} inputs", folder.display(), inputs.len());
    }
    Ok(())
}
