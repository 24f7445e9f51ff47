//! d
use lindstedt_impact::parameters::*; use lindstedt_impact::*;
#[test] fn d(){ let p=Parameters{alpha:1.0,omega:2.6,periods:1,restitution:0.8,wall:0.0,damping:0.05,force:1.0,displacement_gain:0.08,velocity_gain:0.0,branch:Branch::Plus};
 let o=orbit::orbit(&p).unwrap(); println!("{o:?}"); println!("{:?}", flight::clearance(&p,&o)); }
