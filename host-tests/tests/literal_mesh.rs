use strainwave_app::{JOINT, literal_mesh::wind_up};
#[test]
fn x() {
    let t = std::time::Instant::now();
    for h in [1] {} println!("{:?} {:?}", wind_up(&JOINT), t.elapsed());
    let mut j = JOINT;
    j.gear.flexspline.cup.ellipse = 2.9e-3;
    println!("{:?}", wind_up(&j));
    j.gear.flexspline.cup.ellipse = 1e-3;
    println!("{:?}", wind_up(&j));
    panic!();
}
