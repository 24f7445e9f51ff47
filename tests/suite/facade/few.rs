//! Digits of a sum of few terms.

use lindstedt::Status;
use lindstedt::unstable::evaluation::few::plain;
use lindstedt::unstable::number::ball::Balls;
use rug::Float;

/// pi with nothing known of its error, and with one of 1e-3.
#[test]
fn digits_shown() {
    let balls = Balls::new(200);
    let pi = balls.pi();
    let unknown = plain(&pi, 30, false).unwrap();
    assert_eq!((&*unknown.decimal, unknown.status), ("3.142", Status::NoEstimate));
    assert_eq!(plain(&pi, 1, false).unwrap().decimal, "3");
    let measured = plain(&balls.add_error(&pi, &Float::with_val(53, 1e-3)), 30, true).unwrap();
    assert_eq!((&*measured.decimal, measured.status), ("3.1416", Status::Estimated));
    assert!(measured.error.unwrap().parse::<f64>().unwrap() >= 1e-3);
}
