//! One column of a bifurcation diagram, and its line in the file of the sweep.

use crate::arguments::Section;
use lindstedt::Exact;
use lindstedt::simulate::{Column, Point, Quantity};
use rug::Rational;
use rug::ops::Pow;
use std::fmt::Write as _;

/// The points over one value, or why there are none.
pub struct Line {
    pub value: f64,
    /// As the user would write it.
    pub exact: String,
    pub points: Vec<[f64; 2]>,
    pub failure: Option<String>,
}

/// A decimal number where it ends after at most 17 digits, a fraction otherwise, a multiple of pi,
/// or 17 digits.
fn exact(q: &Quantity) -> String {
    match q {
        Quantity::Exact(Exact::Rational(q)) => decimal(q).unwrap_or_else(|| q.to_string()),
        Quantity::Exact(Exact::PiTimes(q)) => match (q.numer().to_string().as_str(), q.denom()) {
            ("1", d) if *d == 1 => "pi".to_owned(),
            (_, d) if *d == 1 => format!("{}*pi", q.numer()),
            ("1", d) => format!("pi/{d}"),
            (n, d) => format!("{n}*pi/{d}"),
        },
        other => format!("{:?}", other.float(53).to_f64()),
    }
}

/// The digits of a decimal number, exactly.
fn decimal(q: &Rational) -> Option<String> {
    let places = (0..=17u32).find(|n| {
        let power = rug::Integer::from(10).pow(*n);
        Rational::from(q * power).is_integer()
    })?;
    let scaled = Rational::from(q * rug::Integer::from(10).pow(places)).numer().clone();
    let digits =
        format!("{:0>width$}", scaled.clone().abs().to_string(), width = places as usize + 1);
    let (whole, rest) = digits.split_at(digits.len() - places as usize);
    let sign = if scaled < 0 { "-" } else { "" };
    let point = if rest.is_empty() { "" } else { "." };
    Some(format!("{sign}{whole}{point}{rest}"))
}

impl Line {
    pub fn of(column: &Column<f64>, values: &[Quantity], section: Section) -> Self {
        let quantity = values.get(column.index);
        let value = quantity.map_or(f64::NAN, |q| q.float(53).to_f64());
        let exact = quantity.map_or_else(String::new, exact);
        let pair = |p: &Point<f64>| {
            let state = if section == Section::Impact { &p.before } else { &p.state };
            match state[..] {
                [x, v, ..] => [x, v],
                _ => [f64::NAN; 2],
            }
        };
        match &column.points {
            Ok(points) => {
                let points = points.iter().map(pair).collect();
                Self { value, exact, points, failure: None }
            }
            Err(error) => {
                let failure = Some(error.to_string());
                Self { value, exact, points: Vec::new(), failure }
            }
        }
    }

    /// The least and the largest x (0) or x' (1) of the points.
    pub fn span(&self, coordinate: usize) -> Option<[f64; 2]> {
        let mut values = self.points.iter().map(|point| point[coordinate]);
        let first = values.next()?;
        Some(values.fold([first; 2], |[least, largest], x| [least.min(x), largest.max(x)]))
    }

    /// `index value x,v x,v ...` or `index value ! reason`.
    pub fn text(&self, index: usize) -> String {
        let mut text = format!("{index} {:?}", self.value);
        for [x, v] in &self.points {
            let _ = write!(text, " {x:?},{v:?}");
        }
        if let Some(failure) = &self.failure {
            let _ = write!(text, " ! {failure}");
        }
        text.push('\n');
        text
    }

    /// A whole line of that index; nothing for any other text.
    pub fn read(text: &str, index: usize, quantity: &Quantity) -> Option<Self> {
        let (value, exact) = (quantity.float(53).to_f64(), exact(quantity));
        let line = text.strip_suffix('\n')?;
        let (body, failure) = match line.split_once(" ! ") {
            Some((body, failure)) => (body, Some(failure.to_owned())),
            None => (line, None),
        };
        let mut words = body.split(' ');
        if words.next()? != index.to_string() || words.next()? != format!("{value:?}") {
            return None;
        }
        let pair = |word: &str| -> Option<[f64; 2]> {
            let (x, v) = word.split_once(',')?;
            Some([x.parse().ok()?, v.parse().ok()?])
        };
        let points = words.map(pair).collect::<Option<Vec<_>>>()?;
        Some(Self { value, exact, points, failure })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_as_they_are_written() {
        let q = |p: i64, r: i64| Rational::from((p, r));
        for (value, text) in
            [(q(3, 5), "0.6"), (q(-1, 40), "-0.025"), (q(7, 1), "7"), (q(1, 3), "1/3")]
        {
            assert_eq!(exact(&value.into()), text);
        }
        for (value, text) in
            [(q(1, 1), "pi"), (q(0, 1), "0"), (q(3, 4), "3*pi/4"), (q(-2, 1), "-2*pi")]
        {
            assert_eq!(exact(&Exact::pi_times(value).into()), text);
        }
    }
}
