//! Quotients of polynomials.

use lindstedt::unstable::coeff::quotient::Quotients;

#[test]
fn quotients_cancel_when_compared() {
    let q = Quotients::new(&["x", "cos", "sin"], &[("cos", "sin")]);
    let [x, cos, sin] = ["x", "cos", "sin"].map(|name| q.parameter(name));
    let one = q.integer(1);
    // sin/(1 - cos) = (1 + cos)/sin.
    let left = q.div(&sin, &q.sub(&one, &cos));
    let right = q.div(&q.add(&one, &cos), &sin);
    assert!(left.zip(right).is_some_and(|(left, right)| q.equal(&left, &right)));
    let inverse = q.inverse(&q.mul(&x, &x));
    assert_eq!(inverse.map(|f| q.print(&f)), Some("x^(-2)".to_owned()));
    assert!(q.inverse(&q.sub(&x, &x)).is_none());
    assert!(!q.equal(&cos, &sin));
}
