//! From the expression tree to the tape.

use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::quantity::Parameters;
use crate::tape::{Op, Tape};
use lindstedt_equation::{Expression, Function, Unknown};
use rug::{Float, Rational};

/// An expression, compiled: constants are folded at 64 bits more than the precision and rounded
/// once.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Constant(Float),
    Row(usize),
}

/// The argument of a sign or absolute value.
#[derive(Clone, Debug)]
pub(crate) struct Switch {
    pub(crate) row: usize,
    /// Its derivative in each direction of the linearisation.
    pub(crate) tangents: Vec<Option<usize>>,
    /// Whether a power that is no integer makes its zero a branch point.
    pub(crate) branch: bool,
    /// Whether the right side jumps with it (a sign, no absolute value).
    pub(crate) jumps: bool,
    /// The operations that its row (and tangents) need, in order.
    pub(crate) cone: Vec<usize>,
}

/// A tape in the making.
pub(crate) struct Compiler<'a, R: Real> {
    pub(crate) real: &'a R,
    pub(crate) tape: Tape<R::Element>,
    pub(crate) switches: Vec<Switch>,
    pub(crate) delays: Vec<Float>,
    /// The constants of the tape, before rounding.
    exact: Vec<Float>,
    pub(crate) parameters: &'a Parameters,
    pub(crate) small: Option<&'a str>,
    /// Names of the states; x_k is state 2 k and x_k' state 2 k + 1, k from 0.
    pub(crate) names: &'a [String],
    variables: usize,
}

impl<'a, R: Real> Compiler<'a, R> {
    /// `variables` states that expressions may name, `states` rows in all.
    pub(crate) fn new(
        real: &'a R,
        (variables, states): (usize, usize),
        names: &'a [String],
        (parameters, small): (&'a Parameters, Option<&'a str>),
    ) -> Self {
        Self {
            real,
            tape: Tape {
                states,
                ops: Vec::new(),
                affine: Vec::new(),
                live: Vec::new(),
                curved: Vec::new(),
                needed: Vec::new(),
                first: Vec::new(),
                controls: Vec::new(),
                controlled: Default::default(),
                steps: Vec::new(),
                constants: Vec::new(),
            },
            switches: Vec::new(),
            delays: Vec::new(),
            exact: Vec::new(),
            parameters,
            small,
            names,
            variables,
        }
    }

    pub(crate) fn bits(&self) -> u32 {
        self.real.bits() + 64
    }

    pub(crate) fn float(&self, n: impl Into<Rational>) -> Float {
        Float::with_val(self.bits(), n.into())
    }

    /// The row of an operation, an existing one if there is one.
    pub(crate) fn push(&mut self, op: Op) -> usize {
        let states = self.tape.states;
        if let Some(index) = self.tape.ops.iter().position(|known| *known == op) {
            return states + index;
        }
        let affine = match op {
            Op::Constant(_) | Op::Time => true,
            Op::Add(a, b) | Op::Subtract(a, b) => self.is_affine(a) && self.is_affine(b),
            Op::Scale(a, _) => self.is_affine(a),
            _ => false,
        };
        self.tape.ops.push(op);
        self.tape.affine.push(affine);
        states + self.tape.ops.len() - 1
    }

    fn is_affine(&self, row: usize) -> bool {
        let index = row.checked_sub(self.tape.states);
        index.and_then(|index| self.tape.affine.get(index)).copied().unwrap_or(false)
    }

    /// The place of a constant in the table.
    pub(crate) fn constant(&mut self, value: &Float) -> usize {
        let element = self.real.float(value);
        let constants = &mut self.tape.constants;
        constants.iter().position(|known| *known == element).unwrap_or_else(|| {
            constants.push(element);
            self.exact.push(value.clone());
            constants.len() - 1
        })
    }

    /// The value as a row.
    pub(crate) fn row(&mut self, value: Value) -> usize {
        match value {
            Value::Row(row) => row,
            Value::Constant(c) => {
                let c = self.constant(&c);
                self.push(Op::Constant(c))
            }
        }
    }

    /// The index of the switch with this argument.
    pub(crate) fn switch(&mut self, row: usize, branch: bool) -> usize {
        let known = self.switches.iter().position(|switch| switch.row == row);
        let index = known.unwrap_or_else(|| {
            let (tangents, cone) = (Vec::new(), Vec::new());
            self.switches.push(Switch { row, tangents, branch: false, jumps: false, cone });
            self.switches.len() - 1
        });
        self.switches[index].branch |= branch;
        index
    }

    /// Compiles an expression.
    pub(crate) fn expression(&mut self, expression: &Expression) -> Result<Value, SimulateError> {
        Ok(match expression {
            Expression::Number(q) => Value::Constant(self.float(q.clone())),
            Expression::Parameter(name) => {
                match self.names.iter().position(|state| state == name) {
                    Some(state) => self.state(state, None)?,
                    None => Value::Constant(self.parameter(name)?),
                }
            }
            Expression::Small => {
                let name = self.small.unwrap_or("the small parameter").to_owned();
                Value::Constant(self.parameter(&name)?)
            }
            Expression::Unknown(Unknown { index, derivative: derivative @ (0 | 1), delay }) => {
                let by = delay.as_deref().map(|by| self.delay(by)).transpose()?;
                self.state(2 * index + *derivative as usize, by.as_ref())?
            }
            Expression::Unknown(_) => return Err(SimulateError::UnexpectedState),
            Expression::Time => Value::Row(self.push(Op::Time)),
            Expression::Sum(terms) => {
                let mut total = Value::Constant(self.float(0));
                for term in terms {
                    let term = self.expression(term)?;
                    total = self.sum(total, term);
                }
                total
            }
            Expression::Product(factors) => {
                let mut constant = Value::Constant(self.float(1));
                let split = factors.iter().partition(|factor| self.is_constant(factor));
                let (constants, mut others): (Vec<_>, Vec<_>) = split;
                for factor in constants {
                    let factor = self.expression(factor)?;
                    constant = self.product(constant, factor);
                }
                // A gain of zero: what it multiplies (a delayed term) is not there.
                if matches!(&constant, Value::Constant(zero) if zero.is_zero()) {
                    return Ok(constant);
                }
                let mut total = self.removable_quotient(&mut others)?;
                let quotient = self.modulus_quotient(&mut others)?;
                total = self.product(total, quotient);
                for factor in others {
                    let factor = self.expression(factor)?;
                    total = self.product(total, factor);
                }
                self.product(constant, total)
            }
            Expression::Power(base, exponent) => self.power(base, exponent)?,
            Expression::Function(function, argument) => {
                let argument = match function {
                    // sign(w^3) = sign(w), whose zero is simple.
                    Function::Sign => self.odd_root(argument).unwrap_or((**argument).clone()),
                    _ => (**argument).clone(),
                };
                let argument = self.expression(&argument)?;
                self.function(*function, argument)
            }
            Expression::Formal(name, _) => {
                return Err(SimulateError::FormalFunction { name: name.clone() });
            }
        })
    }

    /// Whether neither states nor the time stand in the expression.
    pub(crate) fn is_constant(&self, expression: &Expression) -> bool {
        match expression {
            Expression::Number(_) | Expression::Small => true,
            Expression::Parameter(name) => !self.names.contains(name),
            Expression::Sum(list) | Expression::Product(list) => {
                list.iter().all(|e| self.is_constant(e))
            }
            Expression::Power(a, b) => self.is_constant(a) && self.is_constant(b),
            Expression::Function(_, a) => self.is_constant(a),
            _ => false,
        }
    }

    fn parameter(&self, name: &str) -> Result<Float, SimulateError> {
        let value = self.parameters.get(name);
        let value = value.ok_or_else(|| SimulateError::MissingParameter { name: name.to_owned() });
        Ok(value?.float(self.bits()))
    }

    /// The value of a delay.
    fn delay(&mut self, by: &Expression) -> Result<Float, SimulateError> {
        match self.expression(by)? {
            Value::Constant(by) if by.is_finite() && by > 0 => Ok(by),
            Value::Constant(by) => Err(SimulateError::BadDelay { delay: by.to_f64() }),
            Value::Row(_) => Err(SimulateError::UnexpectedState),
        }
    }

    fn state(&mut self, state: usize, delay: Option<&Float>) -> Result<Value, SimulateError> {
        if state >= self.variables {
            return Err(SimulateError::UnexpectedState);
        }
        let Some(delay) = delay else { return Ok(Value::Row(state)) };
        let known = self.delays.iter().position(|known| known == delay);
        let delay = known.unwrap_or_else(|| {
            self.delays.push(delay.clone());
            self.delays.len() - 1
        });
        Ok(Value::Row(self.push(Op::Delayed { state, delay })))
    }

    pub(crate) fn sum(&mut self, a: Value, b: Value) -> Value {
        match (a, b) {
            (Value::Constant(a), Value::Constant(b)) => Value::Constant(a + b),
            (Value::Constant(zero), other) | (other, Value::Constant(zero)) if zero.is_zero() => {
                other
            }
            (a, b) => {
                let (a, b) = (self.row(a), self.row(b));
                Value::Row(self.push(Op::Add(a, b)))
            }
        }
    }

    pub(crate) fn product(&mut self, a: Value, b: Value) -> Value {
        match (a, b) {
            (Value::Constant(a), Value::Constant(b)) => Value::Constant(a * b),
            (Value::Constant(c), Value::Row(row)) | (Value::Row(row), Value::Constant(c)) => {
                if c == 1 {
                    return Value::Row(row);
                }
                if c.is_zero() {
                    return Value::Constant(c);
                }
                // One factor instead of two.
                if let Some((inner, known)) = self.scaled(row) {
                    return self.product(Value::Constant(c * known), Value::Row(inner));
                }
                let c = self.constant(&c);
                Value::Row(self.push(Op::Scale(row, c)))
            }
            (Value::Row(a), Value::Row(b)) if a == b => Value::Row(self.push(Op::Square(a))),
            (Value::Row(a), Value::Row(b)) => Value::Row(self.push(Op::Multiply(a, b))),
        }
    }

    pub(crate) fn function(&mut self, function: Function, argument: Value) -> Value {
        let row = match argument {
            Value::Row(row) => row,
            Value::Constant(x) => {
                return Value::Constant(match function {
                    Function::Ln => x.ln(),
                    Function::Exp => x.exp(),
                    Function::Sin => x.sin(),
                    Function::Cos => x.cos(),
                    Function::Abs => x.abs(),
                    Function::Sign if x.is_zero() => x,
                    Function::Sign => x.signum(),
                });
            }
        };
        // |c w| = |c| |w|: the arguments c w and w switch together.
        if let (Function::Abs | Function::Sign, Some((inner, factor))) =
            (function, self.scaled(row))
        {
            let factor = self.function(function, Value::Constant(factor));
            let inner = self.function(function, Value::Row(inner));
            return self.product(factor, inner);
        }
        Value::Row(match function {
            Function::Ln => self.push(Op::Ln(row)),
            Function::Exp => self.push(Op::Exp(row)),
            Function::Sin => self.sine(row),
            Function::Cos => self.sine(row) + 1,
            Function::Abs => {
                let switch = self.switch(row, false);
                self.push(Op::Signed(row, switch))
            }
            Function::Sign => {
                let switch = self.switch(row, false);
                self.switches[switch].jumps = true;
                self.push(Op::Control { switch, part: 0 })
            }
        })
    }

    /// The row and the constant of which a row is the product.
    pub(crate) fn scaled(&self, row: usize) -> Option<(usize, Float)> {
        match self.tape.ops.get(row.checked_sub(self.tape.states)?)? {
            Op::Scale(inner, constant) => Some((*inner, self.exact[*constant].clone())),
            _ => None,
        }
    }

    /// The row of the sine; the cosine is the next one.
    pub(crate) fn sine(&mut self, argument: usize) -> usize {
        let affine = self.is_affine(argument);
        let row = self.push(Op::Sin { argument, affine });
        self.push(Op::Cos { argument, affine });
        row
    }

    pub(crate) fn quotient(&mut self, a: Value, b: Value) -> Value {
        match (a, b) {
            (a, Value::Constant(b)) => self.product(a, Value::Constant(b.recip())),
            (a, b) => {
                let (a, b) = (self.row(a), self.row(b));
                Value::Row(self.push(Op::Divide(a, b)))
            }
        }
    }
}
