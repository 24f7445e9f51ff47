//! The changes of one place that a slip of the pen is: another symbol, a sign, an exponent, a
//! number, two things interchanged, one left out or one too many.

use super::formula::Tree;
use rug::Rational;

/// A changed formula and what was changed.
pub(super) struct Edit {
    pub tree: Tree,
    pub what: String,
}

/// All changes of one place. The likelier ones come first: signs, symbols, exchanges.
pub(super) fn edits(tree: &Tree, vocabulary: &[String]) -> Vec<Edit> {
    let paths = tree.paths();
    let places: Vec<String> = paths.iter().map(|path| place(tree, path)).collect();
    let mut list = Vec::new();
    for kind in [signs, functions, symbols, omissions, insertions, numbers] {
        for (path, place) in paths.iter().zip(&places) {
            if let Some(node) = tree.at(path) {
                kind(node, vocabulary, &mut |new, what| {
                    let what = format!("{what}{place}");
                    list.push(Edit { tree: tree.with(path, new), what });
                });
            }
        }
    }
    exchanges(tree, &paths, &mut list);
    list
}

type Report<'a> = dyn FnMut(Tree, String) + 'a;

/// " in TERM", the innermost term that holds the node but is not the node.
fn place(tree: &Tree, path: &[usize]) -> String {
    for length in (0..path.len()).rev() {
        let node = path.get(..length).and_then(|path| tree.at(path));
        if let Some(node @ Tree::Product(_)) = node {
            let above = length.checked_sub(1).and_then(|n| tree.at(path.get(..n)?));
            let sign = if matches!(above, Some(Tree::Negative(_))) { "-" } else { "" };
            let text = node.print();
            if text.len() < 60 {
                return format!(" in ${sign}{text}$");
            }
        }
    }
    String::new()
}

fn signs(node: &Tree, _: &[String], report: &mut Report<'_>) {
    if let Tree::Sum(terms) = node {
        for (n, term) in terms.iter().enumerate() {
            let (flipped, sign, inner) = match term {
                Tree::Negative(inner) => ((**inner).clone(), '+', inner.print()),
                other => (Tree::Negative(Box::new(other.clone())), '-', other.print()),
            };
            let what = format!("the sign of ${inner}$ is {sign}");
            report(node.with(&[n], flipped), what);
        }
    }
    if let Tree::Negative(inner) = node {
        report((**inner).clone(), format!("the sign of ${}$ is +", inner.print()));
    }
}

fn functions(node: &Tree, _: &[String], report: &mut Report<'_>) {
    let Tree::Apply(name, argument) = node else { return };
    let other = match name.as_str() {
        "cos" => "sin",
        "sin" => "cos",
        "exp" => {
            let opposite = match &**argument {
                Tree::Negative(inner) => (**inner).clone(),
                other => Tree::Negative(Box::new(other.clone())),
            };
            let new = Tree::Apply(name.clone(), Box::new(opposite));
            let what = format!("${}$ in the place of ${}$", new.print(), node.print());
            return report(new, what);
        }
        _ => return,
    };
    let new = Tree::Apply(other.to_owned(), argument.clone());
    let what = format!("${}$ in the place of ${}$", new.print(), node.print());
    report(new, what);
}

fn symbols(node: &Tree, vocabulary: &[String], report: &mut Report<'_>) {
    let Tree::Symbol(name) = node else { return };
    for other in vocabulary.iter().filter(|other| *other != name) {
        report(Tree::Symbol(other.clone()), format!("${other}$ in the place of ${name}$"));
    }
}

fn omissions(node: &Tree, _: &[String], report: &mut Report<'_>) {
    let (Tree::Sum(list) | Tree::Product(list)) = node else { return };
    for (n, part) in list.iter().enumerate() {
        let mut rest = list.clone();
        rest.remove(n);
        let rest = match node {
            Tree::Sum(_) => Tree::Sum(rest),
            _ => Tree::Product(rest),
        };
        report(rest, format!("${}$ does not belong there", part.print()));
    }
}

fn insertions(node: &Tree, vocabulary: &[String], report: &mut Report<'_>) {
    let short = matches!(node, Tree::Symbol(_) | Tree::Apply(..) | Tree::Number(_));
    if !short {
        return;
    }
    for word in vocabulary {
        let product = Tree::Product(vec![node.clone(), Tree::Symbol(word.clone())]);
        report(product, format!("a factor ${word}$ is missing beside ${}$", node.print()));
    }
}

fn numbers(node: &Tree, _: &[String], report: &mut Report<'_>) {
    match node {
        Tree::Number(q) => {
            for other in (1..=4).map(Rational::from).filter(|other| other != q) {
                let what = format!("{other} in the place of {q}");
                report(Tree::Number(other), what);
            }
        }
        Tree::Power(base, exponent) => {
            for other in [1, 2, 3, 4, -exponent].into_iter().filter(|other| other != exponent) {
                let new = Tree::Power(base.clone(), other);
                let what = format!("${}$ in the place of ${}$", new.print(), node.print());
                report(new, what);
            }
        }
        _ => {}
    }
}

/// Two symbols, or two values of one function, interchanged.
fn exchanges(tree: &Tree, paths: &[Vec<usize>], list: &mut Vec<Edit>) {
    let mut leaves: Vec<(&Vec<usize>, &Tree)> = Vec::new();
    for path in paths {
        if let Some(node @ (Tree::Symbol(_) | Tree::Apply(..))) = tree.at(path) {
            leaves.push((path, node));
        }
    }
    for (n, (first, a)) in leaves.iter().enumerate() {
        for (second, b) in leaves.iter().skip(n + 1) {
            let alike = match (a, b) {
                (Tree::Symbol(_), Tree::Symbol(_)) => true,
                (Tree::Apply(f, _), Tree::Apply(g, _)) => f == g,
                _ => false,
            };
            if alike && a != b && !second.starts_with(first) {
                let what = format!("${}$ and ${}$ are interchanged", a.print(), b.print());
                let changed = tree.with(first, (*b).clone()).with(second, (*a).clone());
                list.push(Edit { tree: changed, what });
            }
        }
    }
}
