//! Stopping within an order: after every number of questions the result is a prefix of the whole
//! one, and the questions within one order are many. Counted, not timed.

use lindstedt::evaluate::Times;
use lindstedt::evaluate::averaged::{AveragedMotion, Start};
use lindstedt::grid::Axis;
use lindstedt::unstable::algebra::Stop;
use lindstedt::unstable::derivation::averaging::{Averaging, AveragingSettings, average};
use lindstedt::unstable::derivation::numeric::{Tier, derive as derive_numbers};
use lindstedt::unstable::series::resummation::{
    Method, ResummationError, Sample, UniformMap, resum,
};
use lindstedt::{
    Derivation, DerivationError as Error, Evaluate, Exact, Kind, Oscillator, Progress, Refusal,
    Respond, Route, Standing, Work, unstable::derivation::Settings, unstable::derivation::derive,
    unstable::problems,
};
use rug::Float;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Stops at the question with this number; and the number of questions so far.
fn after(limit: u64) -> (Stop, Arc<AtomicU64>) {
    let asked = Arc::new(AtomicU64::new(0));
    let counter = Arc::clone(&asked);
    (Stop::new(move || counter.fetch_add(1, Ordering::SeqCst) >= limit), asked)
}

fn interrupted<T>(result: &Result<T, impl Refusal>) -> bool {
    result.as_ref().is_err_and(|error| error.kind() == Kind::Stopped)
}

fn lobachevsky(name: &str, order: usize, stop: Stop) -> (Result<Derivation, Error>, Vec<usize>) {
    let settings = Settings { order, stop, route: Route::Driver, ..Settings::default() };
    let mut orders = Vec::new();
    let mut observer = |progress: Progress| {
        if let Progress::Order(n, _) = progress {
            orders.push(n);
        }
        true
    };
    let result = derive(&problems::find(name).unwrap(), &settings, &mut observer);
    (result, orders)
}

#[test]
fn orders_of_the_lobachevsky_ring() {
    for (name, order) in [("power-law", 6), ("pendulum", 4)] {
        let (stop, asked) = after(u64::MAX);
        let whole = lobachevsky(name, order, stop).0.unwrap();
        let total = asked.load(Ordering::SeqCst);
        assert!(total > 100 * order as u64, "{name}: {total} questions");
        let mut seen = std::collections::BTreeSet::new();
        let mut unchecked = 0;
        let stops = (0..40).map(|i| total * i / 40).chain([1, 2, 3, total - 1]);
        for limit in stops {
            let (stop, asked) = after(limit);
            let (result, orders) = lobachevsky(name, order, stop);
            let more = asked.load(Ordering::SeqCst).saturating_sub(limit);
            // Threads that are asking when the first answer comes may ask once each.
            let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
            assert!(more <= threads + 1, "{name}: {more} questions after the answer");
            match result {
                Ok(result) => {
                    // Every order that was announced is there, exact; nothing of the next one.
                    assert_eq!(result.order, orders.len(), "{name} {limit}");
                    for series in &result.series {
                        let complete = whole.named(series.quantity).unwrap();
                        assert_eq!(series.coefficients.len(), result.order + 1);
                        assert_eq!(
                            series.coefficients[..],
                            complete.coefficients[..=result.order],
                            "{name} {limit} {}",
                            series.quantity
                        );
                    }
                    for n in 0..=result.order {
                        let style = lindstedt::unstable::coeff::print::Style::Text;
                        assert_eq!(result.print_solution(n, style), whole.print_solution(n, style));
                    }
                    unchecked += usize::from(result.checked_orders.is_none());
                    assert!(result.checked_orders.is_none_or(|n| n == result.order));
                    seen.insert(result.order);
                }
                Err(error) => {
                    assert!(interrupted::<()>(&Err(error)), "{name} {limit}");
                    assert!(orders.is_empty());
                }
            }
        }
        assert!(seen.len() > order / 2 && unchecked > 30, "{name}: {seen:?} {unchecked}");
    }
}

/// By the clock the orders are finished together: an error before, and nothing unchecked that says it is checked.
#[test]
fn one_clock() {
    for (name, order) in [("power-law", 8), ("pendulum", 6)] {
        let run = |stop| {
            let settings = Settings { order, stop, route: Route::Clock, ..Settings::default() };
            derive(&problems::find(name).unwrap(), &settings, &mut |_| true)
        };
        let (stop, asked) = after(u64::MAX);
        assert_eq!(run(stop).unwrap().checked_orders, Some(order));
        let total = asked.load(Ordering::SeqCst);
        assert!(total > 20 * order as u64, "{name}: {total} questions");
        let (mut none, mut unchecked) = (0, 0);
        for i in 0..40 {
            let (stop, _) = after(total * i / 40);
            match run(stop) {
                Ok(result) => {
                    assert_eq!((result.order, result.checked_orders), (order, None), "{name} {i}");
                    unchecked += 1;
                }
                Err(error) => {
                    assert!(interrupted::<()>(&Err(error)), "{name} {i}");
                    none += 1;
                }
            }
        }
        assert!(none > 5 && unchecked > 5, "{name}: {none} {unchecked}");
    }
}

/// Over Q the orders are finished together: an error, whenever it is stopped.
#[test]
fn primes() {
    for (name, order) in [("duffing", 12), ("van-der-pol", 10)] {
        let run = |stop| {
            let settings = Settings { order, stop, ..Settings::default() };
            derive(&problems::find(name).unwrap(), &settings, &mut |_| true)
        };
        let (stop, asked) = after(u64::MAX);
        assert!(run(stop).is_ok());
        let total = asked.load(Ordering::SeqCst);
        assert!(total > 3 * order as u64, "{name}: {total} questions");
        for i in 0..20 {
            let (stop, _) = after(total * i / 20);
            assert!(interrupted(&run(stop)), "{name} {i}");
        }
    }
}

#[test]
fn grids() {
    for (name, tier) in [
        ("power-law", Tier::Collocation { digits: 20 }),
        ("power-law", Tier::Doubles),
        ("van-der-pol", Tier::Fourier { harmonics: 20 }),
    ] {
        let run = |stop| {
            let settings = Settings { order: 6, stop, ..Settings::default() };
            let mut orders = 0;
            let mut observer = |_: &lindstedt::unstable::expand::OrderWork| {
                orders += 1;
                true
            };
            let problem = problems::find(name).unwrap();
            let result = derive_numbers(&problem, &settings, tier, &mut observer);
            (result, orders)
        };
        let (stop, asked) = after(u64::MAX);
        let (whole, orders) = run(stop);
        assert!(whole.is_ok());
        let total = asked.load(Ordering::SeqCst);
        assert!(total > 3 * orders, "{name}: {total} questions in {orders} orders");
        for i in 0..20 {
            let (stop, _) = after(total * i / 20);
            assert!(interrupted(&run(stop).0), "{name} {tier:?} {i}");
        }
    }
}

#[test]
fn averaged_rates() {
    let problem = problems::vibro_impact::problem();
    let run = |values: bool, stop| -> Result<(Averaging, bool), Error> {
        let list = [
            ("alpha", "1"),
            ("omega", "13/5"),
            ("c", "1/20"),
            ("A", "1/10"),
            ("B", "1/10"),
            ("k", "1"),
            ("P0", "1"),
        ];
        let list = list.iter().filter(|_| values);
        let parameters = list.map(|(n, v)| ((*n).to_owned(), Exact::parse(v).unwrap())).collect();
        let settings =
            AveragingSettings { order: 8, parameters, stop, ..AveragingSettings::default() };
        let mut read = false;
        let mut observer = |progress: Progress| {
            read |= matches!(progress, Progress::Reading);
            true
        };
        average(&problem, &settings, &mut observer).map(|found| (found, read))
    };
    for values in [true, false] {
        let (stop, asked) = after(u64::MAX);
        let (whole, read) = run(values, stop).unwrap();
        assert!(!read);
        let total = asked.load(Ordering::SeqCst);
        // An order of a linear equation is a few products: it is asked at each, and within long ones.
        assert!(total > 8, "{total} questions");
        let mut seen = std::collections::BTreeSet::new();
        for i in 0..30 {
            let (stop, _) = after(total * i / 30);
            let result = run(values, stop);
            let Ok((found, read)) = result else {
                assert!(interrupted(&result), "{:?}", result.err());
                continue;
            };
            // Limits do not end the reading of what is finished.
            assert_eq!(read, found.checked_orders == 0);
            assert!(found.checked_orders == 0 || found.checked_orders == found.order);
            assert_eq!(found.amplitude_rate[..], whole.amplitude_rate[..=found.order]);
            assert_eq!(found.phase_rate[..], whole.phase_rate[..=found.order]);
            assert_eq!(found.solution[..], whole.solution[..=found.order]);
            seen.insert(found.order);
        }
        assert!(seen.len() > 1, "{seen:?}");
    }
}

/// Sums of van der Pol's period: questions in every elimination, zero, node and re-expansion of
/// every method, and nothing of a sum that was broken off.
#[test]
fn resummations() {
    let coefficient = |n: u32, bits: u32| {
        // sqrt(1 + x + x^2) e^(-x/3) has a pair of branch points, as the period has.
        let mut y = vec![Float::with_val(bits, 1), Float::with_val(bits, 1) / 2u32];
        for k in 2..=n {
            let last = Float::with_val(bits, &y[k as usize - 1] * (3 - 2 * i64::from(k)));
            let before = Float::with_val(bits, &y[k as usize - 2] * (6 - 2 * i64::from(k)));
            y.push((last + before) / (2 * k));
        }
        y.swap_remove(n as usize)
    };
    let source = |bits: u32| {
        Some(Sample {
            coefficients: (0..=16).map(|n| coefficient(n, bits)).collect(),
            point: Float::with_val(bits, 1) / 3u32,
            map: Some(UniformMap {
                scale: Float::with_val(bits, 1),
                prefactor: Float::with_val(bits, 0.5),
                radius: None,
            }),
            radius: None,
            bits,
        })
    };
    for method in std::iter::once(None).chain(Method::ALL.map(Some)) {
        let (stop, asked) = after(u64::MAX);
        let whole = resum(&source, method, 200, &stop).unwrap();
        let total = asked.load(Ordering::SeqCst);
        // The search for the singularity alone has eight eliminations of up to 17 rows.
        assert!(total > 500, "{method:?}: {total} questions");
        let step = total / 40;
        for limit in (0..40).map(|i| i * step).chain([1, 2, total - 2, total - 1]) {
            let (stop, asked) = after(limit);
            let broken = resum(&source, method, 200, &stop);
            assert!(matches!(broken, Err(ResummationError::Stopped)), "{method:?} {limit}");
            assert_eq!(asked.load(Ordering::SeqCst), limit + 1, "{method:?}");
        }
        let (stop, _) = after(total);
        let again = resum(&source, method, 200, &stop).unwrap();
        assert_eq!(again.outcome.estimate.value, whole.outcome.estimate.value);
    }
}

/// A million exact values of a sweep.
#[test]
fn values_of_a_sweep() {
    let text = "sigma=-1..3:1000000";
    let (stop, asked) = after(5);
    let broken = Axis::parse_until(text, &stop);
    assert!(interrupted(&broken) && asked.load(Ordering::SeqCst) == 6);
    let (stop, asked) = after(u64::MAX);
    let whole = Axis::parse_until(text, &stop).unwrap();
    assert!(asked.load(Ordering::SeqCst) > 500 && whole.values.len() == 1_000_000);
}

/// Whole evaluations: most of their questions are those of the resummation.
#[test]
fn evaluations() {
    for name in ["power-law", "pendulum", "duffing", "van-der-pol"] {
        let run = |stop| {
            let question = Evaluate { order: Some(9), ..Evaluate::default() };
            Oscillator::builtin(name)
                .unwrap()
                .evaluate(&question, &Work { stop, ..Work::default() })
        };
        let (stop, asked) = after(u64::MAX);
        assert!(run(stop).is_ok());
        let total = asked.load(Ordering::SeqCst);
        assert!(total > 500, "{name}: {total} questions");
        for i in 0..20 {
            let (stop, _) = after(total * i / 20);
            let stopped = match run(stop) {
                Err(error) => error.kind() == Kind::Stopped,
                // The series is summed: nothing that is finished is thrown away.
                Ok(answer) => answer.standing == Standing::Stopped { done: 0 },
            };
            assert!(stopped, "{name} {i} of {total}");
        }
    }
}

/// Whether normal modes form families is known last: a question about them that is broken off before never says that they
/// form none.
#[test]
fn families_of_normal_modes() {
    let spring =
        Oscillator::file(include_str!("../../docs/examples/pendulum-spring.toml")).unwrap();
    let spring = spring.set("eps", "1/10").unwrap().set("amplitude", "1/2").unwrap();
    for sweep in [None, Some(Axis::parse("amplitude=0.1..1:2").unwrap())] {
        let run = |stop| {
            let question = Respond { order: Some(1), sweep: sweep.clone(), ..Respond::default() };
            spring.respond(&question, &Work { stop, ..Work::default() })
        };
        let (stop, asked) = after(u64::MAX);
        assert!(run(stop).is_ok());
        let total = asked.load(Ordering::SeqCst);
        let derived = (0..total).take_while(|&limit| match run(after(limit).0) {
            Ok(_) => false,
            Err(error) => {
                assert_eq!(error.kind(), Kind::Stopped, "{limit}: {error}");
                true
            }
        });
        assert!(derived.count() > 5, "{total} questions");
    }
}

/// Stopped while a and psi are integrated: a time was asked for, and is not reached.
#[test]
fn averaged_motions() {
    let case = Oscillator::builtin("van-der-pol").unwrap().set("eps", "1/10").unwrap();
    let number = |text| Exact::parse(text).unwrap();
    let start = Start::Amplitude(number("1"), number("0"));
    let times = Some(Times::parse("0,30").unwrap());
    let question = AveragedMotion { order: Some(3), start: Some(start), times };
    let run = |stop| case.averaged_motion(&question, &Work { stop, ..Work::default() }).unwrap();
    let (stop, asked) = after(u64::MAX);
    assert_eq!(run(stop).standing, Standing::Complete);
    let found = run(after(asked.load(Ordering::SeqCst) - 10).0);
    let said = found.value.verdict();
    assert!(said.contains("integrated to none of the times after 0"), "{said}");
    assert!(matches!(found.standing, Standing::Stopped { .. }));
}
