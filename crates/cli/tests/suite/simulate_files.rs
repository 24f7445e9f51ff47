//! `lindstedt simulate FILE.toml`: walls, dry friction, delays with a history, start values, and
//! the built-in problems from their printed files.

use crate::program::{self, Folder, float, json, lindstedt, root, without};
use serde_json::Value;

fn simulate(arguments: &[&str]) -> Value {
    without(json(&[&["simulate", "--quiet"], arguments].concat()), &["seconds"])
}

fn refuses(arguments: &[&str], exit: i32, words: &str) {
    program::refuses(&[&["simulate", "--quiet"], arguments].concat(), exit, words);
}

fn end(found: &Value) -> [f64; 2] {
    [float(&found["final"]["x"]), float(&found["final"]["v"])]
}

#[test]
fn every_example_moves() {
    let mut count = 0;
    for entry in std::fs::read_dir(root().join("docs/examples")).unwrap() {
        let path = entry.unwrap().path();
        let line = [path.to_str().unwrap(), "--until", "3", "--digits", "10"];
        if path.ends_with("wright-hopf.toml") {
            refuses(&line, 3, "of first order");
            continue;
        }
        // The gain of the loop is what its file seeks.
        let sought: &[&str] =
            if path.ends_with("delay-loop.toml") { &["--set", "B=0"] } else { &[] };
        let found = simulate(&[&line, sought].concat());
        assert!((float(&found["final"]["t"]) - 3.0).abs() < 1e-12, "{}", path.display());
        count += 1;
    }
    assert!(count >= 12);
}

#[test]
fn built_in_problems_move_as_their_printed_files() {
    let folder = Folder::new("moves");
    let cases: [(&str, &[&str]); 9] = [
        ("power-law", &["--until", "5", "--set", "n=2"]),
        ("pendulum", &["--until", "5", "--set", "amplitude=2"]),
        ("pendulum", &["--until", "2", "--set", "delta=1/2"]),
        ("duffing", &["--until", "5", "--set", "eps=-1/4"]),
        ("van-der-pol", &["--until", "5"]),
        ("stick-slip", &["--until", "20"]),
        ("vibro-impact", &["--impacts", "4", "--set", "A=1/10", "--perturb", "1e-3"]),
        ("vibro-impact", &["--impacts", "4", "--set", "B=1/10", "--state=-3/2,1/2"]),
        ("vibro-impact", &["--sweep", "A=0..1/10:3", "--skip", "5", "--impacts", "4"]),
    ];
    for (name, arguments) in cases {
        let path = folder.file("x.toml", program::text(&["problems", "--show", name]));
        let run = |problem: &str| simulate(&[&[problem], arguments].concat());
        assert_eq!(run(name), run(&path), "{name} {arguments:?}");
    }
    // The same state with the history said, by the general route.
    let path = folder.path("x.toml");
    let base = ["--state=-3/2,1/2", "--set", "A=1/10", "--impacts", "5"];
    let said = [&[&*path], &base[..], &["--history", "free-flight"]].concat();
    let built_in = simulate(&[&["vibro-impact"], &base[..]].concat());
    assert_eq!(simulate(&said)["events"], built_in["events"]);
    // And another history is another motion.
    let constant = [&["vibro-impact"], &base[..], &["--history", "constant"]].concat();
    let other = simulate(&constant);
    assert_ne!(other["events"], built_in["events"]);
    assert!(other.to_string().contains("x(t) = x(0) before t = 0"));
}

/// The periodic impact orbit is the start of what has the form of the built-in oscillator, whatever its
/// parameters are called; one term more, and the start is a state.
#[test]
fn the_orbit_is_recognised_by_its_form() {
    let folder = Folder::new("form");
    let file = |more: &str| {
        format!(
            "name = 'other'\nequation = \"x'' + d x' + w0^2 x{more} = F cos(W t) + g (x - x(t - late))\"\n\
             condition = []\n[parameters]\nw0 = {{ value = '1' }}\nd = {{ value = '1/5' }}\n\
             F = {{ value = '1' }}\nW = {{ value = '3.3' }}\ng = {{ value = '1/50' }}\n\
             late = {{}}\nm = {{ value = '1' }}\n[impact]\nposition = '-1/5'\ncrossing = 'rising'\n\
             restitution = '3/5'\n[synchronous]\ndelay = 'late'\nperiods = 'm'\nfrequency = 'W'\n"
        )
    };
    let ask = ["--perturb", "1/1000", "--impacts", "4", "--digits", "12"];
    let own = simulate(&[&[&*folder.file("other.toml", file(""))], &ask[..]].concat());
    let known = simulate(&[&["vibro-impact", "--set", "A=1/50"], &ask[..]].concat());
    assert_eq!(own["growth"], known["growth"]);
    assert_eq!(own["events"], known["events"]);
    let path = folder.file("cubic.toml", file(" + x^3"));
    refuses(&[&[&*path], &ask[..]].concat(), 2, "starts at a state");
    assert!(simulate(&[&path, "--impacts", "1"])["start"]["chosen"].is_string());
}

/// x'' + x/2 + x(t - 2 pi)/2 = 0 has the solution cos t, of period 2 pi; so has x'' + x = 0, its
/// free flight.
#[test]
fn histories() {
    let folder = Folder::new("histories");
    let file = |initial: &str| {
        format!(
            "name = 'late'\nequation = \"x'' + x/2 + x(t - T)/2 = 0\"\ncondition = []\n[parameters]\n\
             T = {{ value = '2*pi' }}\n[initial]\n{initial}"
        )
    };
    let exact = [10f64.cos(), -10f64.sin()];
    let cases = [
        ("cosine", "history = 'cos(t)'", true),
        ("shifted", "history = 'cos(t) + 0*T'\nx = '1'\nvelocity = '0'", true),
        ("flight", "x = '1'\nvelocity = '0'\nhistory = 'free-flight'", true),
        ("constant", "x = '1'\nvelocity = '0'\nhistory = 'constant'", false),
        ("usual", "x = '1'\nvelocity = '0'", false),
    ];
    let mut last = Vec::new();
    for (name, initial, is_cosine) in cases {
        let path = folder.file("x.toml", file(initial));
        let found = simulate(&[&path, "--until", "10", "--digits", "20"]);
        let state = end(&found);
        let near = (0..2).all(|k| (state[k] - exact[k]).abs() < 1e-14);
        assert_eq!(near, is_cosine, "{name}: {state:?}");
        assert!(found["history"].is_string(), "{name}");
        last.push(state);
    }
    assert_eq!(last[3], last[4]);
    // Before 2 pi the constant history is a constant force: x = -1 + 2 cos(t/sqrt 2).
    let path = folder.file("constant.toml", file("x = '1'\nvelocity = '0'"));
    let [x, _] = end(&simulate(&[&path, "--until", "6", "--digits", "20"]));
    assert!((x - (-1.0 + 2.0 * (6.0 / 2f64.sqrt()).cos())).abs() < 1e-14, "{x}");
    // What the command line says comes first.
    let [x, _] = end(&simulate(&[&path, "--until", "10", "--history", "cos(t)"]));
    assert!((x - exact[0]).abs() < 1e-14);
    // No closed form of the free flight; x in a history.
    let nonlinear =
        file("history = 'free-flight'\nx = '1'\nvelocity = '0'").replace("x/2 +", "x^3 +");
    let path = folder.file("nonlinear.toml", &nonlinear);
    refuses(&[&path], 3, "not linear");
    let path = folder.file("state.toml", file("history = 'x'"));
    refuses(&[&path], 2, "a history is an expression in t");
}

/// x'' = -x from (1, 0) reaches the wall at -1/2 after 2 pi/3 with -sqrt(3)/2.
#[test]
fn walls() {
    let folder = Folder::new("walls");
    let text = "name = 'wall'\nequation = \"x'' + k x = 0\"\ncondition = []\n[parameters]\n\
                k = { value = '1' }\nR = { value = '4/5' }\n[initial]\nx = '1'\nvelocity = '0'\n\
                [impact]\nposition = '-1/2'\ncrossing = 'falling'\nrestitution = 'R'\n";
    let path = folder.file("wall.toml", text);
    let found = simulate(&[&path, "--impacts", "2"]);
    let events = found["events"].as_array().unwrap();
    let time = 2.0 * std::f64::consts::PI / 3.0;
    assert!((float(&events[0]["t"]) - time).abs() < 1e-14);
    assert!((float(&events[0]["v_after"]) - 0.8 * 0.75f64.sqrt()).abs() < 1e-14, "{}", events[0]);
    // Sweeps of the wall's own parameter, fixed ones, ranges of the file.
    refuses(&[&path, "--sweep", "k"], 2, "gives no range for k");
    let ranged = text.replace("condition", "swept = ['R=1/2..4/5:3']\nfixed = ['k']\ncondition");
    let path = folder.file("ranged.toml", &ranged);
    let swept = simulate(&[&path, "--sweep", "R", "--skip", "0", "--impacts", "2"]);
    assert_eq!(swept["sweep"]["columns"].as_array().unwrap().len(), 3);
    refuses(&[&path, "--sweep", "k=1..2:3"], 2, "is fixed in the file");
    // A start behind the wall, and a restitution above one.
    refuses(&[&path, "--state=-1,0"], 3, "behind the wall at x = ");
    refuses(&[&path, "--set", "R=2"], 3, "restitution");
}

/// At rest at a wall until the force that the body would leave with points away: of time alone, a root; with dry
/// friction that holds it, 1/2 = -cos t.
#[test]
fn rests_at_walls() {
    let folder = Folder::new("rests");
    let wall = |name: &str, equations: &str, restitution: &str, start: &str| {
        let text = format!(
            "{equations}\n[impact]\nposition = '0'\ncrossing = 'rising'\nrestitution = '{restitution}'\n\
             [initial]\nx = '{start}'\nvelocity = '0'\n"
        );
        folder.file(name, &text)
    };
    let force = |t: f64| 0.96 + 0.5 * (4.7 * t + 0.75).cos() - 0.046 * t;
    let (mut low, mut high) = (11.0, 11.2);
    while high - low > 1e-13 {
        let middle = (low + high) / 2.0;
        if force(middle) > 0.0 { low = middle } else { high = middle }
    }
    let slow = "equation = \"x'' = 0.96 + 0.5*cos(4.7*t + 0.75) - 0.046*t\"";
    let held = "equation = \"x'' + sign(x')/2 = cos(t)\"";
    for (name, equation, start, leaves) in [
        ("slow.toml", slow, "-1/100", low),
        ("held.toml", held, "-1/10", 2.0 * std::f64::consts::FRAC_PI_3),
    ] {
        let path = wall(name, equation, "0", start);
        for way in [&["--digits", "12"][..], &["--digits", "30"], &["--f64"]] {
            let found = simulate(&[&[&*path, "--until", "11.3"], way].concat());
            let events = found["events"].as_array().unwrap();
            let departure = events.iter().find(|e| e["kind"] == "departure").unwrap();
            assert!((float(&departure["t"]) - leaves).abs() < 1e-10, "{name} {way:?} {departure}");
            assert!(events.len() < 5, "{name} {way:?} {events:?}");
        }
    }
    // Flights that end with sqrt(b/a) times their velocity, a = 5/4 on the way out and b = 3/4 on that back.
    // At a wall off zero flights turn within rounding errors of it, long before they are short.
    let path = wall("chatter.toml", "equation = \"x'' + sign(x')/4 = 1\"", "1/2", "-1");
    let text = std::fs::read_to_string(&path).unwrap().replace("'-1'", "'-1/2'");
    let beside = folder.file("beside.toml", text.replace("position = '0'", "position = '1/2'"));
    let (a, b) = (1.25f64, 0.75f64);
    let leaves = 0.5 * (2.0 * b).sqrt();
    let ends =
        (2.0 / b).sqrt() + leaves * (1.0 / a + 1.0 / (a * b).sqrt()) / (1.0 - 0.5 * (b / a).sqrt());
    let ways = [&["--digits", "12"][..], &["--digits", "30"], &["--f64"]];
    for (path, way) in ways.iter().flat_map(|way| [(&path, way), (&beside, way)]) {
        let found = simulate(&[&[&**path, "--until", "6"], *way].concat());
        let events = found["events"].as_array().unwrap();
        let end = events.iter().find(|e| e["kind"] == "accumulation").unwrap();
        assert!((float(&end["t"]) - ends).abs() < 1e-9, "{way:?} {end} {ends}");
        assert_eq!(float(&found["final"]["v"]), 0.0, "{way:?}");
    }
    // A belt that begins to move away from the wall, cos(3*pi/2) = 0, takes the body along.
    let belt = "equation = \"x'' + 0.21*x' + 0.38*x - 0.59*sin(x) - 1.43*cos(2.48*t) + 0.81 + 0.26*sign(x - 0.27) + \
                0.33*sign(x' - 0.41*cos(t)) = 0\"";
    let path = wall("belt.toml", belt, "0", "-6/25");
    let text = std::fs::read_to_string(&path).unwrap();
    let text = text.replace("'0'\ncrossing = 'rising'", "'-3/5'\ncrossing = 'falling'");
    let path = folder.file("belt.toml", text.replace("velocity = '0'", "velocity = '-3/50'"));
    for way in [&["--digits", "12"][..], &["--digits", "25"], &["--f64"]] {
        let found = simulate(&[&[&*path, "--until", "4.9"], way].concat());
        let v = float(&found["final"]["v"]);
        assert!((v - 0.41 * 4.9f64.cos()).abs() < 1e-12, "{way:?} {v}");
    }
    // A force that touches zero without a change of its sign ends no rest.
    let path = wall("touch.toml", "equation = \"x'' + x'/5 = cos(t)^2\"", "3/10", "0");
    for way in [&["--digits", "12"][..], &["--digits", "22"], &["--f64"]] {
        let found = simulate(&[&[&*path, "--until", "15"], way].concat());
        let events = found["events"].as_array().unwrap();
        assert!(events.len() == 1 && events[0]["kind"] == "rest", "{way:?} {events:?}");
    }
    let two = wall("two.toml", "equations = [\"x'' + x + y/10 = 0\", \"y'' + y = 0\"]", "1", "0");
    refuses(&[&two, "--state=-1,0,0,0"], 3, "a wall is for one unknown");
}

/// An equation without a small parameter moves as it is: x'^2/2 - cos x = -cos 2. Expansions say what they
/// miss.
#[test]
fn without_a_small_parameter() {
    let folder = Folder::new("plain");
    let file = |force: &str| format!("name = 'plain'\nequation = \"x'' + {force} = 0\"\n");
    let found = simulate(&[&folder.file("pendulum.toml", file("sin(x)")), "--until", "7"]);
    let [x, v] = ["x", "v"].map(|name| float(&found["final"][name]));
    assert!((v * v / 2.0 - x.cos() + 2f64.cos()).abs() < 1e-14, "{x} {v}");
    for (force, reason) in [
        ("x", "the small parameter eps does not occur"),
        ("x + x^3", "x^3 has no factor eps"),
        ("x'/10 + x - 2*cos(3*t/2)", "1/10*x' has no factor eps"),
        ("1 - cos(t)", "no term k*x stands in the equation without eps"),
    ] {
        let path = folder.file("bare.toml", file(force));
        for verb in ["derive", "evaluate", "verify"] {
            for words in [reason, "marks the small terms"] {
                program::refuses(&[verb, "--quiet", &path], 3, words);
            }
        }
    }
}

/// x'' + x = -m sign x' from (1, 0), m = 3/10: turning points -2/5 and, |x| > m no more after
/// -1/5, rest there (each half oscillation loses 2 m).
#[test]
fn dry_friction() {
    let folder = Folder::new("friction");
    let text = "name = 'rub'\nequation = \"x'' + x + eps m sign(x') = 0\"\ncondition = []\n\
                [parameters]\nm = { value = '3/10' }\n[initial]\nx = '1'\nvelocity = '0'\n";
    let path = folder.file("rub.toml", text);
    let found = simulate(&[&path, "--until", "10"]);
    let [x, v] = end(&found);
    assert!((x + 0.2).abs() < 1e-14 && v.abs() < 1e-14, "{x} {v}");
    let kinds: Vec<&str> =
        found["events"].as_array().unwrap().iter().map(|e| e["kind"].as_str().unwrap()).collect();
    assert!(kinds.contains(&"stick"), "{kinds:?}");
}

/// What determines a parameter (`follows`) is computed: x'' + (2 pi)^2 x = 0 has period 1.
#[test]
fn determined_parameters() {
    let folder = Folder::new("follows");
    let text = "name = 'f'\nequation = \"x'' + k x = 0\"\ncondition = []\n[parameters]\n\
                k = { follows = '4*pi^2/p^2' }\np = { value = '1' }\n";
    let path = folder.file("follows.toml", text);
    let [x, v] = end(&simulate(&[&path, "--until", "1", "--state", "1,1"]));
    assert!((x - 1.0).abs() < 1e-14 && (v - 1.0).abs() < 1e-14, "{x} {v}");
    let [x, _] = end(&simulate(&[&path, "--until", "1", "--state", "1,1", "--set", "p=2"]));
    assert!((x + 1.0).abs() < 1e-14, "{x}");
    let path = folder.file("words.toml", text.replace("4*pi^2/p^2", "see the notes"));
    refuses(&[&path], 2, "follows of k: the name see");
}

/// x'' + x = 2 (x^2 + x'^2) from rest at 1: p = x'^2 obeys dp/dx = 4 p + 4 x^2 - 2 x, so
/// x'^2 = e^(4 (x - 1)) - x^2, and x grows like a logarithm up to
/// t = int_1^oo dx/sqrt(e^(4 (x - 1)) - x^2) = 0.97653202 by quadrature.
#[test]
fn a_motion_that_ends_is_shown_up_to_its_end() {
    let folder = Folder::new("ends");
    let file = folder
        .file("ends.toml", "name = \"ends\"\nequation = \"x'' + x + eps*(x^2 + x'^2) = 0\"\n");
    let command = ["simulate", &file, "--set", "eps=-2", "--periods", "2", "--digits", "15"];
    let output = lindstedt(&[&command[..], &["--quiet", "--format", "json"]].concat());
    assert_eq!(output.status.code(), Some(3));
    let warning = String::from_utf8(output.stderr).unwrap();
    assert!(warning.contains("x' grows beyond all bounds near t = 0.976532 "), "{warning}");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["complete"], false);
    let [x, v] = end(&found);
    let energy = (4.0 * (x - 1.0)).exp() - x * x;
    assert!(v > 100.0, "{v}");
    assert!((v * v / energy - 1.0).abs() < 1e-11, "{x} {v}");
}
