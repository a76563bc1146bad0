use std::time::Instant;
use lichtenberg::{graph::*, math::*, plan::*};
fn run<const N: usize>(size: [f64;3], alpha: f64) {
    let w = Window::new(DVec3::ZERO, DVec3::from_array(size) - 1.0, 1.0, if N==4||N==8 {2} else {3}).unwrap();
    let l: Lattice<N> = Lattice::new(w, &Stream::new(1,"x"), Weights{max:10.0, alpha}, None::<([bool;3], fn(DVec3)->FieldValue)>, None).unwrap();
    let root = l.node(w.size.map(|s| s/2));
    let mut best=f64::MAX;
    for _ in 0..3 {
    let t = Instant::now();
    let p = plan(&l, &[root], Goal::Everything, &Progress::default()).unwrap();
    let s = t.elapsed().as_secs_f64();
    best=best.min(s);
    if p.settled() as u64 != w.nodes() {println!("settled {}", p.settled());}
    }
    println!("N={N} {size:?} alpha {alpha}: {best:.3} s, {:.1} ns/node", best*1e9/w.nodes() as f64);
}
fn main(){ if let Some(a) = std::env::args().nth(1) { if a == "2d" { for _ in 0..5 {run::<4>([2048.,2048.,1.],3.0);} return } if a=="3d" { run::<6>([256.,256.,256.],3.0); return } }
    run::<4>([2048.,2048.,1.],3.0);
    run::<8>([2048.,2048.,1.],3.0);
    run::<6>([80.,80.,80.],1.0);
    run::<6>([80.,80.,80.],3.0);
    run::<18>([80.,80.,80.],3.0);
    run::<26>([80.,80.,80.],3.0);
    run::<6>([256.,256.,256.],3.0);
    let f = std::fs::read_to_string("/proc/self/status").unwrap();
    println!("{}", f.lines().find(|l| l.starts_with("VmHWM")).unwrap());
    if std::env::args().nth(1).is_some() {
    run::<6>([512.,512.,512.],3.0);
    let f = std::fs::read_to_string("/proc/self/status").unwrap();
    println!("{}", f.lines().find(|l| l.starts_with("VmHWM")).unwrap());
    }
}
