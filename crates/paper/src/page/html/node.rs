//! The parts of a formula as it is set.

/// A part of a formula.
#[derive(Clone, Debug)]
pub enum Node {
    /// A letter, in italics.
    Letter(String),
    /// A function or another word, upright.
    Upright(String),
    Number(String),
    /// A sign; true where a line may be broken before it.
    Operator(String, bool),
    /// A small space between factors.
    Space,
    Group {
        open: &'static str,
        close: &'static str,
        body: Vec<Node>,
        length: usize,
    },
    /// Several that stay together.
    Row(Vec<Node>),
    Fraction(Vec<Node>, Vec<Node>),
    Root(Vec<Node>),
    Scripts {
        base: Box<Node>,
        below: Vec<Node>,
        above: Vec<Node>,
    },
}

impl Node {
    /// Whether it can be divided: neither sign nor space.
    pub fn is_factor(&self) -> bool {
        !matches!(self, Self::Operator(..) | Self::Space)
    }
}

/// How many marks wide it is, about.
pub fn length(nodes: &[Node]) -> usize {
    let of = |node: &Node| match node {
        Node::Letter(s) | Node::Upright(s) | Node::Number(s) | Node::Operator(s, _) => {
            s.chars().count()
        }
        Node::Space => 1,
        Node::Group { length, .. } => *length,
        Node::Fraction(a, b) => length(a).max(length(b)),
        Node::Row(a) => length(a),
        Node::Root(a) => 1 + length(a),
        Node::Scripts { base, below, above } => {
            length(std::slice::from_ref(base)) + length(below).max(length(above))
        }
    };
    nodes.iter().map(of).sum()
}
