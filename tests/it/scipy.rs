//! The planner's costs are scipy's, on graphs that the library exports: the comparison that the benches repeat at size.

use std::process::Command;

#[test]
fn costs_equal_scipys() {
    let named = std::env::var("LICHTENBERG_PYTHON").ok();
    let candidates = named.iter().map(String::as_str).chain(["python3", "/usr/bin/python3"]);
    let has_scipy = |python: &&str| {
        Command::new(python).args(["-c", "import numpy, scipy"]).output().is_ok_and(|o| o.status.success())
    };
    let python = candidates.into_iter().find(has_scipy);
    let python = python.expect("this test needs Python with scipy: run ./run-tests, or apt-get install python3-scipy");
    let script = crate::support::root().join("benches/compare_scipy.py");
    let output = Command::new(python)
        .arg(script)
        .arg("--small")
        .arg(crate::support::example("graph"))
        .output()
        .expect("python starts");
    let said = crate::support::text(&output.stdout);
    assert!(output.status.success(), "{said}{}", crate::support::text(&output.stderr));
    assert_eq!(said.matches("costs equal").count(), 6, "{said}");
}
