//! Numbers from the expansion: the period, the motion, the function.

use super::{Pen, Present, problem_at, stability_word};
use crate::figure::{Axis, Mark, colours};
use crate::{Block, Document, Figure, Formula, Table, Text};
use lindstedt::evaluate::averaged::{Moment, Motion, Quantity, SummedCycle};
use lindstedt::evaluate::{
    Displacement, Displacements, Evaluation, ExpansionCode, SolutionCode, method_name,
};
use lindstedt::{Answer, Exact, Number};

/// A value with its error, what is known of that, and what is said where there is no digit.
fn with_error(number: Option<&Number>, known: &str, unknown: &str, none: &str) -> String {
    match number {
        None => none.to_owned(),
        Some(Number { decimal, error: Some(error), .. }) => {
            format!("{decimal} +- {error} ({known})")
        }
        Some(Number { decimal, error: None, .. }) => format!("{decimal} ({unknown})"),
    }
}

impl Present for Answer<Evaluation> {
    fn page(&self, _: Pen) -> Document {
        let value = &self.value;
        let mut lines = periods(self);
        let how = format!("{} of T/(2*pi) in ", method_name(value.resummed.method));
        let how = Text::words(how).code(value.variable.as_str());
        lines.push(("summed".into(), how.and(format!(", order {}", value.order))));
        let tried = value.tried().into_iter();
        lines.extend(tried.map(|(name, found)| (format!("  {name}").into(), found.into())));
        lines.extend(plane(value));
        lines.push(("verdict".into(), value.verdict.as_str().into()));
        let page = Document::titled(problem_at(&self.header)).lines(lines);
        match &value.solution {
            None => page,
            Some(found) => page.words(summed(found)).table(shown(found)),
        }
    }

    fn figure(&self) -> Option<Figure> {
        let found = self.value.solution.as_ref()?;
        let points = found.points.iter().map(|point| (point.time.to_f64(), point.double));
        let title = format!("{}: {}", self.header.problem, summed(found));
        let frame = Figure::new(title, Axis::linear("t"), Axis::linear("x"));
        Some(frame.layer(None, Mark::Line(2), colours::BLUE, points))
    }

    fn table(&self) -> Option<Table> {
        let row = |point: &Displacement| {
            let time = time(&point.time);
            [time, format!("{:?}", point.double), format!("{:e}", point.error)]
        };
        let points = self.value.solution.as_ref()?.points.iter();
        Some(points.map(row).fold(Table::new(["t", "x", "error"]), Table::row))
    }
}

type Line = (Text, Text);

/// Period, frequency, closed form and true error.
fn periods(answer: &Answer<Evaluation>) -> Vec<Line> {
    let value = &answer.value;
    let known = match value.measured_by {
        Some(by) => &format!("by {by}"),
        None => "estimated",
    };
    let number = |number: &Option<Number>| {
        let few = "no estimate from so few coefficients";
        Text::words(with_error(number.as_ref(), known, few, "not one digit"))
    };
    let name = |words: &str, text: &str, latex: &str| {
        Text::words(words).formula(Formula::new(text, latex))
    };
    let mut lines = vec![
        (name("period ", "T", "T"), number(&value.period)),
        (name("frequency ", "2*pi/T", "2\\pi/T"), number(&value.frequency)),
    ];
    if let Some(improved) = &value.improved {
        let sum = with_error(improved.sum.as_ref(), "estimated", "no estimate", "not one digit");
        lines.push(("  by the sum".into(), sum.into()));
    }
    if let Some(exact) = &value.exact_period {
        let form = exact.exact.as_deref().unwrap_or_default();
        let closed = Text::words(format!("{} = ", exact.decimal)).code(form);
        lines.push(("exact period".into(), closed));
    }
    if let Some(found) = &value.stability {
        let exponent = found.floquet_exponent.as_ref();
        let exponent =
            Text::words(with_error(exponent, "estimated", "no estimate", "not one digit"));
        let stable = stability_word(found.stable, "undecided");
        lines.push(("Floquet exponent".into(), exponent.and(format!(": {stable}"))));
    }
    let error = value.true_error.as_deref();
    lines.extend(error.map(|error| (name("true error of ", "T", "T"), error.into())));
    lines
}

/// What is known of the function beyond the real axis.
fn plane(value: &Evaluation) -> Vec<Line> {
    let mut lines = Vec::new();
    if let Some(found) = value.singularity() {
        let [re, im] = &found.at;
        let place = if im == "0" { re.clone() } else { format!("{re} +- {im}*i") };
        let (kind, exponent, error) = (found.kind, found.exponent, found.error);
        let words = format!("{place}, {kind} (exponent {exponent}), error {error}");
        lines.push(("nearest singularity".into(), words.into()));
    }
    if let Some(picture) = &value.picture {
        let doublets = picture.poles.iter().filter(|p| p.doublet).count();
        let (poles, zeros) = (picture.poles.len(), picture.zeros.len());
        let words =
            format!("{poles} poles, {doublets} of them in doublets with a zero, {zeros} zeros");
        lines.push(("diagonal Pade".into(), words.into()));
    }
    lines
}

fn summed(found: &Displacements) -> String {
    if found.is_by_newton() {
        return "x(t) by Newton's method in Fourier space".to_owned();
    }
    format!("x(t), order {}, summed by {}", found.order, found.summed_by())
}

/// A time in tables.
pub(super) fn time(time: &Exact) -> String {
    format!("{:?}", time.to_f64())
}

/// Time, value and error; the error belongs to the digits that are printed.
fn shown(found: &Displacements) -> Table {
    let row = |point: &Displacement| {
        let [value, error] = match &point.value {
            None => ["not one digit".to_owned(), String::new()],
            Some(Number { decimal, error: Some(error), .. }) => {
                [decimal.clone(), format!("+- {error}")]
            }
            Some(Number { decimal, .. }) => [decimal.clone(), "(no estimate)".to_owned()],
        };
        [time(&point.time), value, error]
    };
    found.points.iter().map(row).fold(Table::new(["t", "x", "error"]), Table::row)
}

impl Present for Answer<Motion> {
    fn page(&self, _: Pen) -> Document {
        let motion = &self.value;
        let number = |number: &Option<Number>| {
            let none = "not one digit: the last orders differ by more than its size";
            Text::words(with_error(number.as_ref(), "estimated", "no estimate", none))
        };
        let name = |words: &str, text: &str, latex: &str, rest: &str| {
            Text::words(words).formula(Formula::new(text, latex)).and(rest)
        };
        let [a, psi] = motion.start;
        let [amplitude, phase] = &motion.rate_numbers;
        let mut lines = vec![
            (
                "start".into(),
                name("", "a", "a", &format!(" = {a}, "))
                    .formula(Formula::new("psi", "\\psi"))
                    .and(format!(" = {psi}")),
            ),
            (name("", "a'", "a'", " there"), number(amplitude)),
            (name("", "psi'", "\\psi'", " there"), number(phase)),
        ];
        if let Some([growth, frequency]) = &motion.linear {
            lines.push((name("growth rate ", "a'/a", "a'/a", ""), number(growth)));
            lines.push((name("frequency ", "psi'", "\\psi'", ""), number(frequency)));
        }
        lines.push(("verdict".into(), motion.verdict().into()));
        let page = cycles(Document::titled(problem_at(&self.header)).lines(lines), motion);
        let psi = Text::from(Formula::new("psi", "\\psi"));
        let table = Table::new(["t".into(), "a".into(), psi, Text::words("x")]);
        page.table(self.moments().iter().map(moment).fold(table, Table::row))
    }

    fn figure(&self) -> Option<Figure> {
        self.value.moments.as_ref()?;
        let curve = |value: fn(&Moment) -> f64| {
            self.moments().iter().map(move |m| (m.time.to_f64(), value(m)))
        };
        let order = self.value.order;
        let title = format!("{}: averaged to order {order}, x and +-a", self.header.problem);
        let figure = Figure::new(title, Axis::linear("t"), Axis::linear("x, a"))
            .layer(None, Mark::Line(2), colours::GREY, curve(|m| m.amplitude.double))
            .layer(None, Mark::Line(2), colours::GREY, curve(|m| -m.amplitude.double))
            .layer(None, Mark::Line(2), colours::BLUE, curve(|m| m.displacement.double));
        Some(figure)
    }

    fn table(&self) -> Option<Table> {
        self.value.moments.as_ref()?;
        let head = Table::new(["t", "a", "a_error", "psi", "psi_error", "x", "x_error"]);
        let row = |m: &Moment| {
            let quantities = [&m.amplitude, &m.phase, &m.displacement];
            let cells = quantities.map(|q| [format!("{:?}", q.double), format!("{:e}", q.error)]);
            std::iter::once(time(&m.time)).chain(cells.into_iter().flatten()).collect::<Vec<_>>()
        };
        Some(self.moments().iter().map(row).fold(head, Table::row))
    }
}

/// The limit cycles as numbers.
fn cycles(page: Document, motion: &Motion) -> Document {
    let found = motion.cycles.as_deref().unwrap_or_default();
    if found.is_empty() {
        return page;
    }
    let shown = |number: &Option<Number>| {
        let none = "not one digit";
        Text::words(with_error(number.as_ref(), "estimated", "no estimate", none))
    };
    let row = |cycle: &SummedCycle| {
        let stable = stability_word(cycle.stable, "undecided");
        let numbers = [&cycle.amplitude, &cycle.frequency, &cycle.floquet_exponent].map(shown);
        numbers.into_iter().chain([Text::words(stable)]).collect::<Vec<_>>()
    };
    let head = ["a of a limit cycle", "frequency", "Floquet exponent", "stability"];
    page.table(found.iter().map(row).fold(Table::new(head), Table::row))
}

trait Moments {
    fn moments(&self) -> &[Moment];
}

impl Moments for Answer<Motion> {
    fn moments(&self) -> &[Moment] {
        self.value.moments.as_deref().unwrap_or_default()
    }
}

/// Time and the three quantities with their errors.
fn moment(m: &Moment) -> [Text; 4] {
    let shown = |q: &Quantity| match &q.value {
        Some(Number { decimal, error: Some(error), .. }) => format!("{decimal} +- {error}"),
        Some(Number { decimal, .. }) => format!("{decimal} (no estimate)"),
        // Without the sign of a zero.
        None => format!("{:.1e} +- {:.1e}", q.double + 0.0, q.error),
    };
    let cells = [time(&m.time), shown(&m.amplitude), shown(&m.phase), shown(&m.displacement)];
    cells.map(Text::words)
}

impl Present for Answer<ExpansionCode> {
    fn page(&self, _: Pen) -> Document {
        Document::default().with(Block::Source(self.value.code.clone()))
    }
}

impl Present for Answer<SolutionCode> {
    fn page(&self, _: Pen) -> Document {
        Document::default().with(Block::Source(self.value.code.clone()))
    }
}
