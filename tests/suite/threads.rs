//! One library in sixteen threads at once: no question disturbs another.

use lindstedt::motion::End;
use lindstedt::{Derive, Evaluate, Oscillator, Route, Simulate, Stability, Threshold, Work};
use lindstedt_report::json;
use serde::Serialize;

/// The answer without how long it took.
fn told<T: Serialize>(answer: &T) -> String {
    let text = json(answer).unwrap();
    text.lines().filter(|line| !line.contains("\"seconds\"")).collect()
}

/// One of five questions.
fn ask(which: usize) -> String {
    let work = Work { digits: 12, ..Work::default() };
    let case = |name| Oscillator::builtin(name).unwrap();
    match which % 5 {
        0 => {
            let question = Derive { order: 5, route: Route::Automatic };
            told(&case("van-der-pol").derive(question, &work).unwrap())
        }
        1 => {
            let pendulum = case("pendulum").set("amplitude", "2").unwrap();
            let question = Evaluate { order: Some(5), ..Evaluate::default() };
            told(&pendulum.evaluate(&question, &work).unwrap())
        }
        2 => {
            let question = Simulate { end: Some(End::Impacts(3)), ..Simulate::default() };
            told(&case("vibro-impact").motion(&question, &work).unwrap())
        }
        3 => told(&case("vibro-impact").stability(&Stability::default(), &work).unwrap()),
        _ => told(&case("stick-slip").threshold(&Threshold::default(), &work).unwrap()),
    }
}

#[test]
fn sixteen_threads_find_what_one_finds() {
    let alone: Vec<String> = (0..5).map(ask).collect();
    std::thread::scope(|scope| {
        let threads: Vec<_> =
            (0..16).map(|n| scope.spawn(move || (n, [ask(n), ask(n + 2)]))).collect();
        for thread in threads {
            let (n, found) = thread.join().unwrap();
            assert_eq!(
                found,
                [&alone[n % 5], &alone[(n + 2) % 5]].map(String::clone),
                "thread {n}"
            );
        }
    });
}
