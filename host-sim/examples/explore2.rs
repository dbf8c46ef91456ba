use host_sim::{log::Log, machine::Machine, trace::{fit, model::AxisModel, residual::*, scope, signals::*}, servo};
use std::path::Path;
fn main(){
  let mut args=std::env::args().skip(1);
  let m=Machine::read(Path::new(&args.next().unwrap())).unwrap();
  let names:Vec<String>=m.axis.keys().cloned().collect();
  let logs:Vec<Signals>=args.map(|f|Signals::new(&Log::read(Path::new(&f)).unwrap(),&names)).collect();
  for (i,n) in names.iter().enumerate(){
    let e=Evidence{logs:&logs,names:&names,axis:i,rates:servo::rates(&m)};
    let (sc,nt)=scope::scopes(&m.axis[n],i,&logs);
    println!("{n} {sc:?} {nt:?}");
    let mut model=AxisModel::new(&m.axis[n]);
    for s in &sc {
      if std::env::var("DUMP").is_ok(){ use std::io::Write; for p in e.residuals(&model,s){ let mut o=std::fs::File::create(format!("/tmp/x/{n}_{:?}_{}.csv",p.stage,p.log)).unwrap(); writeln!(o,"c,q,v,a,f,t,r").unwrap(); let sg=&logs[p.log].axes[i]; for k in 0..p.values.len(){ let mo=sg.motor.as_ref().unwrap(); writeln!(o,"{},{},{},{},{},{},{}",sg.command.as_ref().map_or(0.,|c|c[k]),mo.position[k],mo.velocity[k],mo.acceleration[k],sg.force.as_ref().map_or(0.,|f|f.position[k]),sg.table.as_ref().map_or(0.,|f|f.position[k]),p.values[k]).unwrap();}}}
      let p=e.residuals(&model,s); for st in &s.stages {println!("  declared {st:?} rms {:.4} noise {:.4}",rms(&p,*st,&e),e.noise(&model,*st));}
      let t0=std::time::Instant::now();
      let f=fit::fit(&e,&model,s,12); 
      println!("  fit {:?}",t0.elapsed());
      for (a,b) in model.slots(s).iter().zip(&f.slots){println!("    {:.4} -> {:.4} [{:.4},{:.4}]",a.coordinate.value,b.coordinate.value,b.coordinate.lower,b.coordinate.upper);}
      model=f.model;
      let p=e.residuals(&model,s); for st in &s.stages {println!("  fitted {st:?} rms {:.4} noise {:.4}",rms(&p,*st,&e),e.noise(&model,*st));}
    }
  }
}
