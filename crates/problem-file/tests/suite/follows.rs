//! What stands for a parameter: its order, and what determines it.

use lindstedt_equation::Expression;
use lindstedt_problem_file::{ProblemFile, parse_expression};

fn read(rest: &str) -> ProblemFile {
    ProblemFile::parse(&format!("name = \"f\"\n{rest}")).unwrap()
}

/// The left-hand side is that of a file with the same values written out.
#[test]
fn what_determines_a_parameter_stands_in_its_place() {
    let file = read(
        "equation = \"x'' + b*x + c*x^3 = 0\"\norders = { a = 2, c = 1 }\n[parameters]\n\
         a = { value = \"3\" }\nb = { follows = \"c/2 + 1\" }\nc = { follows = \"1/a\" }\n\
         [impact]\nposition = \"b\"\ncrossing = \"rising\"\nrestitution = \"1/2\"\n",
    );
    let direct = |text: &str| parse_expression(text, &file.names).unwrap().canonical();
    // c = eps (1/(eps^2 a)), b = c/2 + 1.
    let c = "eps*(eps^2*a)^(-1)";
    let equation = direct(&format!("x'' + (({c})/2 + 1)*x + ({c})*x^3"));
    assert_eq!(file.problem.equation, equation);
    let wall = file.problem.impact.as_ref().unwrap();
    assert_eq!(wall.position, direct(&format!("({c})/2 + 1")));
    assert_eq!(file.put_in(&Expression::parameter("c")), direct(c));
    assert!(file.determined().is_empty() && file.unused.is_empty());
}

/// pi is no rational number: the name keeps its place and its order.
#[test]
fn what_contains_pi_keeps_its_name() {
    let file = read(
        "equation = \"x'' + x + b*x^3 = 0\"\norders = { b = 1 }\n[parameters]\n\
         p = { value = \"2\" }\nb = { follows = \"q/3\" }\nq = { follows = \"2*pi/p\" }\n",
    );
    let direct = |text: &str| parse_expression(text, &file.names).unwrap().canonical();
    assert_eq!(file.problem.equation, direct("x'' + x + eps*b*x^3"));
    let turn = Expression::from(2) * Expression::parameter("pi");
    let value = turn * Expression::parameter("p").pow(-1);
    let found = |name: &str| file.determined()[name].canonical();
    assert_eq!(found("q"), value.canonical());
    assert_eq!(found("b"), (value * Expression::from(3).pow(-1)).canonical());
}

/// A file that is written and read again is the same problem.
#[test]
fn a_written_file_has_the_same_meaning() {
    let file = read(
        "equation = \"x'' + b*x + eps*g*(x(t - T) - x) - F*cos(w t) = 0\"\n[parameters]\n\
         a = { value = \"3\" }\nb = { follows = \"a^2\" }\ng = { value = \"1\" }\nF = { value = \"1\" }\n\
         k = { value = \"1\" }\nw = { value = \"2\" }\nT = { follows = \"2*pi*k/w\" }\n\
         [synchronous]\ndelay = \"T\"\nperiods = \"k\"\nfrequency = \"w\"\n",
    );
    for text in [file.to_text(), lindstedt_problem_file::write(&file.problem)] {
        let again = ProblemFile::parse(&text).unwrap();
        assert_eq!(again.problem.equation, file.problem.equation, "{text}");
        assert_eq!(again.determined(), file.determined(), "{text}");
    }
}
