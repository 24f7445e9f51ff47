//! The laws, and forms of one function that differ.

use super::*;
use lindstedt_algebra::laws;

#[test]
fn laws_hold() {
    let (points, modulus) = Modular::points_for_degree(24);
    let field = PrimeFields::with_roots_of_unity(modulus).next();
    let a = field.and_then(|field| Modular::new(field, points)).expect("an algebra");
    let n = |k: i64| a.field.integer(&Integer::from(k));
    let mixed =
        a.from_harmonics([vec![n(3), n(-1), n(4), n(0), n(7)], vec![n(0), n(5), n(9), n(-2)]]);
    let odd = a.from_harmonics([vec![n(0), n(2), n(0), n(-6)], Vec::new()]);
    let samples = [a.zero(), a.one(), a.cosine(), a.sine(), mixed, odd];
    // `as_rational` does not apply to a finite field; the other laws do.
    assert_eq!(laws::ring(&a, &samples), Ok(()));
    assert_eq!(laws::derivation_and_solution(&a, &samples), Ok(()));
}

/// Coefficients that are not those of the values, of one function among some, in one place modulo one prime.
#[test]
fn forms_that_differ_are_found() {
    let (points, modulus) = Modular::points_for_first_harmonic(24);
    let field = PrimeFields::with_roots_of_unity(modulus).next().expect("primes");
    let a = Modular::new(field, points).expect("an algebra");
    let n = |k: i64| a.field.integer(&Integer::from(k));
    let mut f: Vec<ModularElement> = (1..6)
        .map(|k| a.from_harmonics([vec![n(k), n(0), n(3)], vec![n(0), n(2), n(1), n(7)]]))
        .collect();
    let powers = vec![(0..5).map(|k| a.field.power(&n(987_654_321), k)).collect()];
    for part in f.iter().flat_map(|f| &f.parts).flatten() {
        part.values();
    }
    assert!(a.forms_agree(&f, &powers));
    for symmetry in SYMMETRIES {
        let right = f[2].clone();
        if let Some(part) = &right.parts[symmetry.index()] {
            let mut values = part.values().to_vec();
            values[points / 2][5] ^= 1;
            let coefficients = part.coefficients().to_vec();
            f[2].parts[symmetry.index()] = part.with_forms(Some(coefficients), Some(values));
            assert!(!a.forms_agree(&f, &powers), "{symmetry:?}");
        }
        f[2] = right;
    }
    // There are no odd cosines.
    assert_eq!(f[2].parts.iter().flatten().count(), 3);
}
