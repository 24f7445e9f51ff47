//! What is integrated: a model (expressions and walls) and its compiled form.

use crate::compile::{Compiler, Switch, Value};
use crate::error::SimulateError;
use crate::integrator::real::Real;
use crate::quantity::Parameters;
use crate::second_order::{Wall, accelerations, compile_wall};
use crate::tape::{Op, Tape};
use lindstedt_equation::{Expression, Impact, Problem};

/// A description of a system of ordinary or delay differential equations with walls, switches
/// (signs and absolute values in the expressions) and sections.
///
/// In expressions x is the first state, x' the second, those of x_2 the third and fourth and so on; states also go by the
/// names given.
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_simulate::{Doubles, Model, Parameters, System};
///
/// let x = Expression::DISPLACEMENT;
/// let oscillator = Model::second_order(&(Expression::ACCELERATION + x))?;
/// let system = oscillator.compile(Doubles, &Parameters::new())?;
/// assert_eq!((system.directions(), system.switches()), (0, 0));
/// # Ok::<(), lindstedt_simulate::SimulateError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    names: Vec<String>,
    right_sides: Vec<Expression>,
    small: Option<String>,
    walls: Vec<Impact>,
    sections: Vec<Expression>,
    history: Vec<Expression>,
    second_order: bool,
    linearised: bool,
}

impl Model {
    /// The equation `equation` = 0, solved for x'' (it must be linear in x''): states x, x'.
    pub fn second_order(equation: &Expression) -> Result<Self, SimulateError> {
        let right = accelerations(&[equation])?;
        let mut model = Self::first_order(&[], &[&[Expression::VELOCITY], &right[..]].concat())?;
        model.second_order = true;
        Ok(model)
    }

    /// Equations `equations`\[k\] = 0 of as many unknowns, solved for the x_k'' (they must be linear in them): states
    /// x_1, x_1', x_2, x_2', ...
    ///
    /// # Errors
    /// [`SimulateError::NotSecondOrder`] where they are not, or do not determine the x_k''.
    pub fn of_unknowns(equations: &[&Expression]) -> Result<Self, SimulateError> {
        if let [equation] = equations {
            return Self::second_order(equation);
        }
        let right = accelerations(equations)?;
        let pairs = right.into_iter().enumerate().flat_map(|(k, e)| [Expression::unknown(k, 1), e]);
        Self::first_order(&[], &pairs.collect::<Vec<_>>())
    }

    /// The system y_k' = `right_sides[k]`; state k goes by `names[k]`, the first two also by x
    /// and x' (which is then no derivative, only a name).
    pub fn first_order(names: &[&str], right_sides: &[Expression]) -> Result<Self, SimulateError> {
        if right_sides.is_empty() || (!names.is_empty() && names.len() != right_sides.len()) {
            let (states, given) = (names.len(), right_sides.len());
            return Err(SimulateError::WrongDimension { states, given });
        }
        Ok(Self {
            names: names.iter().map(|name| (*name).to_owned()).collect(),
            right_sides: right_sides.to_vec(),
            small: None,
            walls: Vec::new(),
            sections: Vec::new(),
            history: Vec::new(),
            second_order: false,
            linearised: false,
        })
    }

    /// The equations of a problem in the time domain, with its wall.
    pub fn of_problem(problem: &Problem) -> Result<Self, SimulateError> {
        let first = problem.time_domain.as_ref().unwrap_or(&problem.equation);
        let equations: Vec<_> = [first].into_iter().chain(&problem.others).collect();
        let mut model = Self::of_unknowns(&equations)?.with_small(&problem.small);
        model.walls.extend(problem.impact.clone());
        Ok(model)
    }

    /// The name under which the small parameter has its value.
    #[must_use]
    pub fn with_small(mut self, name: &str) -> Self {
        self.small = Some(name.to_owned());
        self
    }

    /// With a wall; the system must be of second order.
    #[must_use]
    pub fn with_wall(mut self, wall: Impact) -> Self {
        self.walls.push(wall);
        self
    }

    /// With a section h(x, x', t) = 0, whose crossings are reported and change nothing.
    #[must_use]
    pub fn with_section(mut self, section: Expression) -> Self {
        self.sections.push(section);
        self
    }

    /// With the solution before the start, one expression in t per state; for an equation of
    /// second order one alone also stands for its derivative.
    #[must_use]
    pub fn with_history(mut self, history: &[Expression]) -> Self {
        self.history = history.to_vec();
        self
    }

    /// With the linearised flow: one direction per state.
    #[must_use]
    pub fn linearised(mut self) -> Self {
        self.linearised = true;
        self
    }

    /// The recurrences at one precision and for given parameters.
    pub fn compile<R: Real>(
        &self,
        real: R,
        parameters: &Parameters,
    ) -> Result<System<R>, SimulateError> {
        let n = self.right_sides.len();
        let directions = if self.linearised { n } else { 0 };
        let bindings = (parameters, self.small.as_deref());
        let mut compiler = Compiler::new(&real, (n, n + n * directions), &self.names, bindings);
        let mut right_sides = Vec::new();
        for expression in &self.right_sides {
            let value = compiler.expression(expression)?;
            right_sides.push(compiler.row(value));
        }
        let mut walls = Vec::new();
        for wall in &self.walls {
            walls.push(compile_wall(&mut compiler, wall, self.second_order)?);
        }
        let mut sections = Vec::new();
        for section in &self.sections {
            let value = compiler.expression(section)?;
            sections.push(compiler.row(value));
        }
        if directions > 0 && !compiler.delays.is_empty() {
            return Err(SimulateError::LinearisationWithDelay);
        }
        for direction in 0..directions {
            let tangents = compiler.differentiate(n, direction);
            for k in 0..n {
                let tangent = tangents[right_sides[k]]
                    .map_or_else(|| Value::Constant(compiler.float(0)), Value::Row);
                right_sides.push(compiler.row(tangent));
            }
        }
        let (mut tape, mut switches, delays) = (compiler.tape, compiler.switches, compiler.delays);
        for (index, switch) in switches.iter_mut().enumerate() {
            let rows = switch.tangents.iter().flatten().copied().chain([switch.row]);
            switch.cone = tape.cone(rows.collect());
            let own =
                |op: &usize| matches!(tape.ops[*op], Op::Control { switch, .. } if switch == index);
            if switch.cone.iter().any(own) {
                return Err(SimulateError::NotAffine { switch: index });
            }
        }
        let mut needed = right_sides.clone();
        needed.extend(walls.iter().map(|wall| wall.row).chain(sections.iter().copied()));
        for switch in &switches {
            needed.extend(switch.tangents.iter().flatten().copied().chain([switch.row]));
        }
        let surfaces = switches.iter().map(|switch| switch.row).chain(sections.iter().copied());
        let mut nonlinear: Vec<usize> = surfaces.filter(|row| !tape.is_linear(*row)).collect();
        nonlinear.sort_unstable();
        nonlinear.dedup();
        tape.restrict(&real, needed);
        let delays = delays.iter().map(|delay| real.float(delay)).collect();
        let history = self.compile_history(&real, parameters)?;
        Ok(System {
            real,
            tape,
            variables: n,
            right_sides,
            walls,
            switches,
            sections,
            nonlinear,
            delays,
            history,
        })
    }

    fn compile_history<R: Real>(
        &self,
        real: &R,
        parameters: &Parameters,
    ) -> Result<Option<History<R::Element>>, SimulateError> {
        let (n, given) = (self.right_sides.len(), self.history.len());
        if given == 0 {
            return Ok(None);
        }
        let derived = given == 1 && self.second_order;
        if !derived && given != n {
            return Err(SimulateError::WrongDimension { states: n, given });
        }
        let bindings = (parameters, self.small.as_deref());
        let mut compiler = Compiler::new(real, (0, 0), &[], bindings);
        let mut rows = Vec::new();
        for expression in &self.history {
            let value = compiler.expression(expression)?;
            rows.push(compiler.row(value));
        }
        if !compiler.switches.is_empty() {
            return Err(SimulateError::UnexpectedState);
        }
        let mut tape = compiler.tape;
        tape.restrict(real, rows.clone());
        Ok(Some(History { tape, rows, derived }))
    }
}

/// The solution before the start.
#[derive(Clone, Debug)]
pub(crate) struct History<E> {
    pub(crate) tape: Tape<E>,
    pub(crate) rows: Vec<usize>,
    /// The second state is the derivative of the first.
    pub(crate) derived: bool,
}

/// A system, compiled for one precision and one set of parameters; immutable, shared by any
/// number of integrations.
#[derive(Clone, Debug)]
pub struct System<R: Real> {
    pub(crate) real: R,
    pub(crate) tape: Tape<R::Element>,
    pub(crate) variables: usize,
    /// The row of the derivative of every state, those of the linearisation too.
    pub(crate) right_sides: Vec<usize>,
    pub(crate) walls: Vec<Wall<R::Element>>,
    pub(crate) switches: Vec<Switch>,
    pub(crate) sections: Vec<usize>,
    /// The rows of switches and sections that are no linear functions of states and time.
    pub(crate) nonlinear: Vec<usize>,
    pub(crate) delays: Vec<R::Element>,
    pub(crate) history: Option<History<R::Element>>,
}

impl<R: Real> System<R> {
    /// The arithmetic.
    #[must_use]
    pub fn real(&self) -> &R {
        &self.real
    }

    /// The number of directions of the linearisation: 0 or that of the states.
    #[must_use]
    pub fn directions(&self) -> usize {
        self.tape.states / self.variables - 1
    }

    /// The row of x'' where there are walls.
    pub(crate) fn force(&self) -> usize {
        self.right_sides.get(1).copied().unwrap_or(self.right_sides[0])
    }

    /// The number of switches: different arguments of signs and absolute values.
    #[must_use]
    pub fn switches(&self) -> usize {
        self.switches.len()
    }
}
