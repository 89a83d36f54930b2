//! A laboratory on one machine: 100 hands and 10 programs that follow all of them, through one zenoh router. Prints the lines that
//! arrived, their delay, and the processor time of the whole process.
//!
//! `cargo run --release --features zenoh --example zenoh_load -- [HANDS] [FOLLOWERS] [READINGS PER SECOND] [SECONDS]`

use std::error::Error;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener};
use std::thread;
use std::time::{Duration, Instant};

use ademan::network::zenoh::{Publisher, Subscriber};
use hdrhistogram::Histogram;
use rustix::time::{ClockId, clock_gettime};
use zenoh::{Config, Session, Wait};

/// Length of a line, in bytes: a `text-line` with its 64 angles.
const LINE_BYTES: usize = 400;

/// Longest delay that is told from longer ones, in µs.
const MAX_DELAY_US: u64 = 60_000_000;

fn main() -> Result<(), Box<dyn Error + Send + Sync>> {
    let mut numbers = std::env::args().skip(1).map(|number| number.parse::<u64>());
    let mut number = |default| numbers.next().unwrap_or(Ok(default));
    let (hands, followers) = (number(100)?, number(10)?);
    let (rate_hz, seconds) = (number(100)?, number(10)?);
    let (_router, address) = router()?;
    let start = Instant::now();
    let end = start + Duration::from_secs(3 + seconds);
    let mut followed = Vec::new();
    for _ in 0..followers {
        let subscriber = Subscriber::open(address, "lab/*")?;
        followed.push(thread::spawn(move || follow(subscriber, start, end)));
    }
    let mut sent = Vec::new();
    for hand in 0..hands {
        let publisher = Publisher::open(address, &key(hand))?;
        sent.push(thread::spawn(move || {
            publish(publisher, rate_hz, start, end)
        }));
    }
    let (cpu, from) = (cpu_seconds(), start.elapsed());
    let sent: u64 = sent.into_iter().map(|it| it.join().unwrap_or(0)).sum();
    let (cpu, wall) = (cpu_seconds() - cpu, start.elapsed() - from);
    let mut delays = Histogram::<u64>::new_with_bounds(1, MAX_DELAY_US, 3)?;
    for follower in followed {
        delays.add(follower.join().map_err(|_| "a follower has panicked")?)?;
    }
    let expected = sent * followers;
    let share = 100.0 * delays.len() as f64 / expected as f64;
    println!("{hands} hands at {rate_hz} readings/s, {followers} followers of all");
    println!("received {} of {expected} ({share:.2} %)", delays.len());
    for (name, quantile) in [("median", 0.5), ("p99", 0.99), ("p99.9", 0.999)] {
        println!(
            "{name} {:.2} ms",
            delays.value_at_quantile(quantile) as f64 * 1e-3
        );
    }
    println!(
        "processor: {:.0} % of a core, router, hands and followers together",
        100.0 * cpu / wall.as_secs_f64()
    );
    Ok(())
}

fn key(hand: u64) -> String {
    format!("lab/hand-{hand}")
}

/// Starts a router in this process.
fn router() -> Result<(Session, SocketAddr), Box<dyn Error + Send + Sync>> {
    let address = TcpListener::bind("127.0.0.1:0")?.local_addr()?;
    let mut config = Config::default();
    config.insert_json5("mode", "\"router\"")?;
    config.insert_json5("listen/endpoints", &format!("[\"tcp/{address}\"]"))?;
    config.insert_json5("scouting/multicast/enabled", "false")?;
    Ok((zenoh::open(config).wait()?, address))
}

/// Publishes lines that begin with their time. Returns their number.
fn publish(mut publisher: Publisher, rate_hz: u64, start: Instant, end: Instant) -> u64 {
    let period = Duration::from_secs(1) / rate_hz as u32;
    let (mut next, mut count) = (Instant::now(), 0);
    while next < end {
        thread::sleep(next.saturating_duration_since(Instant::now()));
        let time = start.elapsed().as_micros();
        let line = format!("{time:<width$}\n", width = LINE_BYTES - 1);
        if publisher.write_all(line.as_bytes()).is_err() {
            break;
        }
        count += 1;
        next += period;
    }
    count
}

/// Receives lines until a second after the end. Returns their delays in µs.
fn follow(mut subscriber: Subscriber, start: Instant, end: Instant) -> Histogram<u64> {
    let mut delays = Histogram::new_with_bounds(1, MAX_DELAY_US, 3).expect("valid bounds");
    let mut buffer = [0; 4096];
    while Instant::now() < end + Duration::from_secs(1) {
        if let Ok(length) = subscriber.read(&mut buffer) {
            let now = start.elapsed().as_micros() as u64;
            let text = std::str::from_utf8(&buffer[..length]).unwrap_or_default();
            if let Ok(sent) = text.trim_end().parse::<u64>() {
                delays.saturating_record(now.saturating_sub(sent));
            }
        }
    }
    delays
}

fn cpu_seconds() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}
