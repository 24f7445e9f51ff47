//! Fractions from quotients on one line: what belongs above and below.

use super::node::{Node, length};

/// Fractions with longer parts are written with a slash.
const LONG: usize = 26;

/// A fraction, or a quotient with a slash where a part is long. A single bracket is dropped.
pub fn push_fraction(nodes: &mut Vec<Node>, mut above: Vec<Node>, below: Vec<Node>) {
    // What stands directly before a bracket is applied to it: z(t)/gamma.
    if matches!(above.first(), Some(Node::Group { open: "(", .. }))
        && nodes.last().is_some_and(Node::is_factor)
    {
        above.splice(0..0, nodes.pop());
    } else {
        gather(nodes, &mut above);
    }
    if length(&above) > LONG || length(&below) > LONG || below.is_empty() {
        nodes.extend(above);
        nodes.push(Node::Operator("/".to_owned(), false));
        nodes.extend(below);
        return;
    }
    let bare = |part: Vec<Node>| match <[Node; 1]>::try_from(part) {
        Ok([Node::Group { open: "(", body, .. }]) => body,
        Ok([other]) => vec![other],
        Err(part) => part,
    };
    nodes.push(Node::Fraction(bare(above), bare(below)));
}

/// Takes the letters and numbers before a numerator into it: 2 pi k/omega.
fn gather(nodes: &mut Vec<Node>, above: &mut Vec<Node>) {
    let is_plain = |node: &Node| match node {
        Node::Letter(_) | Node::Number(_) => true,
        Node::Scripts { base, .. } => matches!(**base, Node::Letter(_)),
        _ => false,
    };
    let mut from = nodes.len();
    // 2a/b.
    if matches!(nodes.last(), Some(Node::Number(_))) {
        from -= 1;
    }
    while let Some([factor, Node::Space]) = from.checked_sub(2).and_then(|n| nodes.get(n..from)) {
        if !is_plain(factor) {
            break;
        }
        from -= 2;
    }
    // The argument of a function without brackets (cos 2 beta t/2) stays with it.
    let before = nodes.get(..from);
    let is_argument =
        matches!(before, Some([.., Node::Upright(_) | Node::Scripts { .. }, Node::Space]));
    if !is_argument && from < nodes.len() {
        above.splice(0..0, nodes.drain(from..));
    }
}
