//! The scenes are embedded: a file that is added to them is a change of the program.

fn main() {
    println!("cargo::rerun-if-changed=scenes");
    println!("cargo::rerun-if-changed=templates");
}
