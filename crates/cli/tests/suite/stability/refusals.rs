//! What cannot be answered: exit code and reason.

use super::run;
use serde_json::Value;

#[test]
fn orbits_that_do_not_exist_have_no_verdict() {
    let cases: [(&[&str], &str); 5] = [
        // The free flight has the period of the force.
        (&["--set", "alpha=2", "--set", "omega=1", "--set", "c=0"], "periodic"),
        // The wall beyond the fold.
        (&["--set", "s=5"], "fold"),
        // R_r E = 1 at theta = pi.
        (&["--set", "omega=2", "--set", "R_r=1", "--set", "c=0"], "resonance"),
        // The flight passes through the wall.
        (&["--set", "omega=4.4", "--set", "k=5", "--set", "s=-0.02"], "wall"),
        (&["--set", "P0=1e-30", "--set", "s=-1"], "fold"),
    ];
    for (arguments, words) in cases {
        let output = run(&[arguments, &["--format", "json"]].concat());
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(3), "{arguments:?}: {found}");
        assert_eq!(found["orbit"]["exists"], false, "{arguments:?}");
        assert!(found["exact"]["stable"].is_null());
        assert_eq!(found["error"]["code"], "no-orbit");
        let message = found["error"]["message"].as_str().unwrap();
        assert!(message.to_lowercase().contains(words), "{arguments:?}: {message}");
    }
}
