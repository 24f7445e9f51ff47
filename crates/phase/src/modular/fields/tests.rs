//! Sums, products and powers of residues against integers; long sums; every kind of vector.

use super::*;

fn first(modulus: u64) -> PrimeFields {
    PrimeFields::with_roots_of_unity(modulus).next().expect("primes")
}

fn small(fields: &PrimeFields, n: u32) -> Residues {
    fields.integer(&Integer::from(n))
}

/// Of every length, all bits set and others, of either sign; by pairs there and back.
#[test]
fn agrees_with_integers() {
    let fields = first(24);
    let mut list = vec![Integer::new(), Integer::from(-1), Integer::from(i64::MIN)];
    list.extend(fields.primes().map(Integer::from));
    for bits in (20..9000).step_by(37) {
        let ones = (Integer::from(1) << bits) - 1u32;
        list.push(Integer::from(-&ones) / 3u32);
        list.push(ones);
    }
    let plain = |a: &Residues| fields.reduce(&a.map(u64::from));
    let modulo = |n: &Integer| fields.primes().map(|p| n.mod_u(p));
    let images = fields.integers(list.iter());
    for (n, image) in list.iter().zip(&images) {
        assert_eq!(plain(image), modulo(n), "{n}");
        assert_eq!(fields.integer(n), *image);
        assert_eq!(fields.joined(&fields.parted(image)), *image);
    }
    for (n, m) in list.iter().zip(list.iter().rev()) {
        let (a, b) = (fields.integer(n), fields.integer(m));
        assert_eq!(plain(&fields.mul(&a, &b)), modulo(&Integer::from(n * m)));
        assert_eq!(plain(&fields.add(&a, &b)), modulo(&Integer::from(n + m)));
        assert_eq!(plain(&fields.sub(&a, &b)), modulo(&Integer::from(n - m)));
    }
    let third = fields.rational(&Rational::from((-2, 3)));
    assert_eq!(fields.scale(&third, &Rational::from((-3, 2))), fields.one());
    let root = fields.root_of_unity(24).expect("a root");
    assert_eq!(fields.power(&root, 24), fields.one());
    for n in [8, 12] {
        assert!(fields.power(&root, n).iter().zip(fields.one()).all(|(a, b)| *a != b));
    }
}

/// The largest residues there are, in every number of rows, against products one by one.
#[test]
fn long_sums_do_not_overflow() {
    let fields = first(8);
    let largest = fields.primes().map(|p| p - 1);
    let (row, shorter) = (vec![largest; 20], vec![largest; 13]);
    let square = fields.mul(&largest, &largest);
    for count in 1..50u32 {
        let sum = fields.mul(&square, &small(&fields, count));
        let pairs = vec![(&row[..], &row[..]); count as usize];
        assert_eq!(fields.pointwise(&pairs, 20), vec![sum; 20], "{count}");
        let mut terms = vec![(&row[..], largest); count as usize];
        assert_eq!(fields.combination(&terms), vec![sum; 20], "{count}");
        terms.push((&shorter[..], largest));
        let more = fields.add(&sum, &square);
        let expected: Vec<_> = (0..20).map(|j| if j < 13 { more } else { sum }).collect();
        assert_eq!(fields.combination(&terms), expected, "{count}");
        let pairs = vec![(&largest, &largest); count as usize];
        assert_eq!(fields.sum_of_products(&pairs), sum, "{count}");
    }
    let list: Vec<Residues> = (1..20).map(|n| small(&fields, n)).collect();
    let inverses = fields.reciprocals(&list).expect("units");
    assert!(list.iter().zip(&inverses).all(|(a, b)| fields.mul(a, b) == fields.one()));
    let mut vanishes = fields.one();
    vanishes[3] = 0;
    assert_eq!(fields.reciprocals(&[fields.one(), vanishes]), None);
}

struct Columns<'a>(&'a PrimeFields, &'a [Residues], &'a [Residues]);

impl Kernel for Columns<'_> {
    type Output = Vec<Residues>;

    #[inline(always)]
    fn run<W: Words>(self, words: W) -> Vec<Residues> {
        let Self(fields, matrix, x) = self;
        let mut sums = vec![ZERO; x.len()];
        Moduli::new(words, fields).matrix(matrix, matrix.len() / x.len(), x, &mut sums);
        sums
    }
}

/// The largest residues in matrices longer than those of small transforms.
#[test]
fn long_columns_do_not_overflow() {
    let fields = first(8);
    let largest = fields.primes().map(|p| p - 1);
    let square = fields.mul(&largest, &largest);
    for length in 1..60usize {
        let matrix = vec![largest; length * length.next_multiple_of(4)];
        let sum = fields.mul(&square, &small(&fields, length as u32));
        for fields in fields.on_every_processor() {
            let sums = fields.vectorised(Columns(&fields, &matrix, &vec![largest; length]));
            assert_eq!(sums, vec![sum; length], "{fields:?}");
        }
    }
}

/// All kinds of vectors do the same, also where rows end before a word does.
#[test]
fn every_kind_of_vector_agrees() {
    let fields = first(8);
    let rows: Vec<Vec<Residues>> = (0..40u32)
        .map(|i| (0..23).map(|j| fields.power(&small(&fields, i + 2), 7 * j + i)).collect())
        .collect();
    let largest = vec![fields.primes().map(|p| p - 1); 23];
    for length in [1, 3, 4, 5, 16, 23] {
        let mut pairs: Vec<(&[Residues], &[Residues])> =
            rows.iter().zip(&rows[7..]).map(|(a, b)| (&a[..length], &b[..length])).collect();
        pairs.push((&largest[..length], &largest[..length]));
        pairs.push((&rows[3][..length / 2], &rows[5][..length / 2]));
        let terms: Vec<(&[Residues], Residues)> =
            pairs.iter().map(|(a, b)| (*a, b.first().copied().unwrap_or(ZERO))).collect();
        let one_by_one = |at: &dyn Fn(usize, usize) -> Residues| -> Vec<Residues> {
            let sum = |j: usize| {
                let product = |(i, (a, _)): (usize, &(&[Residues], &[Residues]))| {
                    a.get(j).map_or(ZERO, |a| fields.mul(a, &at(i, j)))
                };
                let products = pairs.iter().enumerate().map(product);
                products.fold(ZERO, |sum, product| fields.add(&sum, &product))
            };
            (0..length).map(sum).collect()
        };
        let products = one_by_one(&|i, j| pairs[i].1[j]);
        let combination = one_by_one(&|i, _| terms[i].1);
        let plain = SumOfProducts { fields: &fields, pairs: &pairs, length }.run(Plain);
        assert_eq!(plain, products);
        // What vanishes is reduced from p itself.
        let minus: Vec<Residues> = rows[3].iter().map(|a| fields.neg(a)).collect();
        let vanishes: [(&[Residues], &[Residues]); 2] =
            [(&rows[3][..length], &rows[5][..length]), (&minus[..length], &rows[5][..length])];
        let plain = SumOfProducts { fields: &fields, pairs: &vanishes, length }.run(Plain);
        assert_eq!(plain, vec![ZERO; length]);
        for fields in fields.on_every_processor() {
            assert_eq!(fields.pointwise(&pairs, length), products, "{length} {fields:?}");
            assert_eq!(fields.pointwise(&vanishes, length), vec![ZERO; length], "{fields:?}");
            assert_eq!(fields.combination(&terms), combination, "{length} {fields:?}");
            // Sums at once, of rows that end apart.
            let sums = fields.sums(&[pairs.clone(), Vec::new(), pairs[34..].to_vec()]);
            let last = fields.pointwise(&pairs[34..], length / 2);
            assert_eq!(sums, [products.clone(), Vec::new(), last], "{length} {fields:?}");
            let sums = fields.sums(&[terms.clone(), terms[5..].to_vec()]);
            assert_eq!(sums, [combination.clone(), fields.combination(&terms[5..])]);
        }
    }
}

/// Those of this processor.
pub(super) fn arches() -> Vec<pulp::Arch> {
    #[cfg(target_arch = "x86_64")]
    {
        let wide = [
            pulp::x86::V3::try_new().map(pulp::Arch::V3),
            pulp::x86::V4::try_new().map(pulp::Arch::V4),
        ];
        wide.into_iter().flatten().chain([pulp::Arch::Scalar]).collect()
    }
    #[cfg(not(target_arch = "x86_64"))]
    vec![pulp::Arch::Scalar]
}
