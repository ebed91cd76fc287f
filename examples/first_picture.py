# SPDX-License-Identifier: GPL-3.0-or-later
"""proto"""
import argparse, atexit, sys, os
from importlib.util import find_spec
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parent)]
from molecule import *

E = os.environ.get
def args():
    argv = sys.argv[sys.argv.index("--")+1:] if "--" in sys.argv else sys.argv[1:]
    p = argparse.ArgumentParser()
    p.add_argument("--output"); p.add_argument("--size", nargs=2, type=int, default=(1200,675)); p.add_argument("--samples", type=int, default=8); p.add_argument("--blend")
    return p.parse_args(argv)

def mesh_of(operator, name, smooth=True, **o):
    getattr(bpy.ops.mesh, f"primitive_{operator}_add")(**o)
    ob = bpy.context.object; m = ob.data; m.name = name
    m.polygons.foreach_set("use_smooth", np.full(len(m.polygons), smooth))
    m.materials.append(None)
    bpy.data.objects.remove(ob)
    return m

def place(mesh, material, name, matrix):
    ob = bpy.data.objects.new(name, mesh)
    ob.material_slots[0].link = "OBJECT"; ob.material_slots[0].material = material
    ob.matrix_basis = matrix
    bpy.context.scene.collection.objects.link(ob)
    return ob

def ball(mesh, material, name, center, radius):
    return place(mesh, material, name, Matrix.Translation(center) @ Matrix.Scale(radius, 4))

def rod(mesh, material, name, base, apex, radius):
    base, apex = Vector(base), Vector(apex); ax = apex-base
    m = Matrix.Translation((base+apex)/2) @ ax.to_track_quat("Z","Y").to_matrix().to_4x4() @ Matrix.Diagonal((radius,radius,ax.length/2,1))
    return place(mesh, material, name, m)

def principled(name, color, lift=0.0, image=None, **inputs):
    mat = bpy.data.materials.new(name)
    if bpy.app.version<(5,0): mat.use_nodes=True
    n = mat.node_tree.nodes["Principled BSDF"]
    n.inputs["Base Color"].default_value = (*color, 1)
    for k,v in inputs.items(): n.inputs[k.replace("_"," ")].default_value = v
    if image:
        t = mat.node_tree.nodes.new("ShaderNodeTexImage"); t.image = image
        mat.node_tree.links.new(t.outputs[0], n.inputs["Base Color"])
        if lift: mat.node_tree.links.new(t.outputs[0], n.inputs["Emission Color"])
    if lift:
        n.inputs["Emission Color"].default_value = (*color, 1); n.inputs["Emission Strength"].default_value = lift
    return mat

def shader(name, kind, **inputs):
    mat = bpy.data.materials.new(name)
    if bpy.app.version<(5,0): mat.use_nodes=True
    t = mat.node_tree; t.nodes.remove(t.nodes["Principled BSDF"])
    n = t.nodes.new(kind)
    for k,v in inputs.items(): n.inputs[k].default_value = v
    t.links.new(n.outputs[0], t.nodes["Material Output"].inputs["Surface"])
    return mat

def rgb(hexa):
    s = np.array([int(hexa[i:i+2],16) for i in (0,2,4)])/255
    return tuple(np.where(s<=0.04045, s/12.92, ((s+0.055)/1.055)**2.4).tolist())

def image_of(name, pixels, float_buffer=False):
    h,w,_ = pixels.shape
    im = bpy.data.images.new(name, w, h, float_buffer=float_buffer)
    if float_buffer: im.colorspace_settings.name = "Linear Rec.709" 
    im.pixels.foreach_set(np.concatenate([pixels, np.ones((h,w,1))],-1).astype(np.float32).ravel()); im.update(); im.pack()
    return im

def directions(h, w):
    v,u = np.meshgrid((np.arange(h)+.5)/h, (np.arange(w)+.5)/w, indexing="ij")
    lat=(v-.5)*np.pi; lon=(u-.5)*2*np.pi
    return np.stack([np.cos(lat)*np.cos(lon), np.cos(lat)*np.sin(lon), np.sin(lat)],-1), lat, lon

def planet(h=512):
    d,lat,lon = directions(h,2*h)
    rng = np.random.default_rng(int(E("SEED","3")))
    f = np.zeros(d.shape[:2])
    for o in range(7):
        n=12; k = rng.normal(size=(n,3)); k*= (1.6*1.9**o)/np.linalg.norm(k,axis=1)[:,None]
        f += np.cos(d@k.T + rng.uniform(0,2*np.pi,n)).sum(-1)/np.sqrt(n)/1.75**o
    f = f - np.quantile(f, .58)
    sea0,sea1,land0,land1,ice = (np.array([int(x[i:i+2],16) for i in (0,2,4)])/255 for x in ("0b2545","2f7f9f","5f8f4e","c9a66b","f4f7fa"))
    s = np.clip(f/1.2+1,0,1)[...,None]**2; c_sea = sea0+(sea1-sea0)*s
    l = np.clip(f/1.0,0,1)[...,None]; c_land = land0+(land1-land0)*l
    c = np.where(f[...,None]>0,c_land,c_sea)
    c = np.where((np.abs(lat)*1.0+0.15*np.tanh(f)>1.22)[...,None], ice, c)
    deg = 15.0
    for a,scale in ((np.degrees(lat),1.0),(np.degrees(lon),np.cos(lat))):
        near = np.abs((a+deg/2)%deg-deg/2)*scale
        c = np.where((near<0.35)[...,None]&(np.abs(np.degrees(lat))<76)[...,None], c*.55+.45*np.array([1,1,1]), c)
    return c

def studio(h=256):
    """World"""
    d,lat,lon = directions(h,2*h)
    t = np.clip(np.degrees(lat)/90,-1,1)
    hor = np.array(rgb(E("HOR","dfe7ee"))); zen=np.array(rgb(E("ZEN","5b7fa6")))
    g = np.clip(t,0,1)[...,None]**.6
    c = hor+(zen-hor)*g
    c = np.where((t<0)[...,None], hor*(1-.5*(-t[...,None])), c)
    def box(az, el, w, hh, power):
        da = np.abs((np.degrees(lon)-az+180)%360-180)/w; de = np.abs(np.degrees(lat)-el)/hh
        s = np.clip((1-np.maximum(da,de))/.15,0,1)[...,None]
        return s*power
    return c + box(-150,50,22,16,8) + box(-30,45,14,22,6) + box(100,55,40,10,1.5)

def two_fold(atoms):
    """center & axis"""
    A,B = (atoms.where((atoms.chain==c)&(atoms.name=="CA")).position for c in "AB")
    c = np.concatenate([A,B]).mean(0)
    U,S,V = np.linalg.svd((A-c).T@(B-c)); R=(U@np.diag([1,1,np.linalg.det(U@V)])@V).T
    w,v = np.linalg.eigh((R+R.T)/2); return c, v[:,-1]

def main():
    a = args()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    import addon
    addon.register(); atexit.register(addon.unregister)
    import time; T=time.time()
    sc = bpy.context.scene
    ball_m = mesh_of("uv_sphere_add"[:-4], "Ball", segments=32, ring_count=16)
    rod_m = mesh_of("cylinder", "Rod", vertices=32, radius=1, depth=2, end_fill_type="NOTHING")
    drum_m = mesh_of("cylinder", "Drum", vertices=32, radius=1, depth=2)
    cone_m = mesh_of("cone", "Cone", vertices=32, radius1=1, depth=2)
    disc_m = mesh_of("circle", "Disc", vertices=32, radius=1, fill_type="NGON")
    quad_m = mesh_of("plane", "Plane", size=2)
    path = Path(list(find_spec("pymol").submodule_search_locations)[0])/"data/tut/1hpv.pdb"
    atoms = read_pdb(path)
    drug = atoms.where(atoms.residue=="478"); prot = atoms.where(np.isin(atoms.chain,["A","B"]))
    c, up = two_fold(prot)
    if (drug.position.mean(0)-c)@up<0: up=-up
    x = principal_axes(prot.position)[0]; x-= (x@up)*up; x/=np.linalg.norm(x)
    F = np.stack([x, np.cross(up,x), up]); 
    if E("FLIP"): F = F*np.array([-1,-1,1])[:,None]
    S = 0.1
    loc = lambda p: (p-drug.position.mean(0))@F.T*S
    P, D = loc(prot.position), loc(drug.position)
    P = P-(P.min(0)+P.max(0))/2
    ax = principal_axes(drug.position); D=(drug.position-drug.position.mean(0))@ax[[0,2,1]].T*[1,-1,1]*S
    t=np.radians(float(E("TURN","0"))); D=D@np.array([[np.cos(t),np.sin(t),0],[-np.sin(t),np.cos(t),0],[0,0,1]])
    if E("TILT"): t=np.radians(float(E("TILT"))); D=D@np.array([[np.cos(t),0,np.sin(t)],[0,1,0],[-np.sin(t),0,np.cos(t)]])
    print("extent", P.min(0), P.max(0), D.min(0), D.max(0))
    # -P[:,2].min()+0.25
    off = np.array([float(v) for v in E("OFF","-0.9,-1.2,1.7").split(",")])
    poff = np.array([float(v) for v in E("POFF","1.2,4.0").split(",")]+[-P[:,2].min()+.16])
    cutaway(prot, P, D, poff, ball_m, rod_m)
    CPK = {"C": rgb(E("CC","e9e5dc")), "N": rgb("2e5fd0"), "O": rgb("d62f2f"), "S": rgb("f2b632")}
    mats = {k: principled(f"Atom {k}", v, lift=.06, Roughness=0.05) for k,v in CPK.items()}
    G = float(E("DRUG","3"))
    dp = D*G+off
    drug2 = Atoms(dp, drug.element, drug.name, drug.residue, drug.chain)
    for i in range(len(drug)): ball(ball_m, mats[drug.element[i]], "Drug", dp[i], float(E("BALL",".05"))*G*(1.12 if drug.element[i]!="C" else 1))
    b = find_bonds(drug)
    for p,q,i in zip(*half_bonds(drug2, b)): rod(rod_m, mats[drug.element[i]], "Bond", p, q, .018*G)
    # props
    glass = shader("Glass","ShaderNodeBsdfGlass", IOR=1.5, Roughness=0.0)
    mirror = shader("Mirror","ShaderNodeBsdfGlossy", Roughness=0.0, Color=(.92,.93,.95,1))
    gold = principled("Cone", rgb(E("CONEC","e39a1f")), lift=.05, Roughness=.05)
    im = image_of("Planet", planet()); 
    globe = principled("Globe",(1,1,1),lift=.05,image=im,Roughness=.05)
    floor = principled("Floor", rgb(E("FLOOR","c9ced6")), Roughness=.05 if E("GLOSS") else .6)
    ped = principled("Pedestal", rgb("1d2733"), Roughness=.05)
    inlay = shader("Inlay","ShaderNodeBsdfGlossy", Roughness=0.0, Color=(.55,.58,.62,1))
    pl = place(quad_m, floor, "Floor", Matrix.Identity(4)); pl.conic.primitive="PLANE"
    R = float(E("PED","2.75"))
    place(drum_m, ped, "Pedestal", Matrix.Translation((off[0],off[1],.06))@Matrix.Diagonal((R,R,.06,1)))
    place(disc_m, inlay, "Inlay", Matrix.Translation((off[0],off[1],.121))@Matrix.Diagonal((R*.94,R*.94,1,1)))
    def v(name, d): return [float(t) for t in E(name,d).split(",")]
    gx,gy,gr = v("GLASS","1.9,-2.6,0.85"); ball(ball_m, glass, "Glass", (gx,gy,gr), gr)
    gx,gy,gr = v("MIRROR","3.6,0.6,1.15"); ball(ball_m, mirror, "Mirror", (gx,gy,gr), gr)
    gx,gy,gr = v("GLOBE","-3.6,-2.0,0.75")
    place(ball_m, globe, "Globe", Matrix.Translation((gx,gy,gr))@Matrix.Rotation(np.radians(23),4,"Y")@Matrix.Rotation(np.radians(float(E("SPIN","60"))),4,"Z")@Matrix.Scale(gr,4))
    gx,gy,gr,gh = v("CONE","3.5,-2.3,0.5,1.1"); place(cone_m, gold, "Cone", Matrix.Translation((gx,gy,gh/2))@Matrix.Diagonal((gr,gr,gh/2,1)))
    # lights
    def light(name, kind, energy, pos, color=(1,1,1)):
        l = bpy.data.lights.new(name, kind); l.energy=energy; l.color=color
        if kind=="SUN": l.angle=0
        else: l.shadow_soft_size=0
        o = bpy.data.objects.new(name, l); o.location=pos
        o.rotation_euler = (-Vector(pos)).to_track_quat("-Z","Y").to_euler()
        sc.collection.objects.link(o)
    k = float(E("KEY","2.2"))
    light("Sun","SUN",k,(-4,-5,7),rgb("fff1de"))
    light("Fill","POINT",float(E("FILL","900")),(7,-7,5),rgb("cfe0ff"))
    light("Front","POINT",float(E("FRONT","700")),(-1,-11,3),(1,1,1))
    light("Rim","POINT",float(E("RIM","900")),(-5,7,6),rgb("ffe2c0"))
    w = bpy.data.worlds.new("Studio"); sc.world=w
    if bpy.app.version<(5,0): w.use_nodes=True
    t=w.node_tree; e=t.nodes.new("ShaderNodeTexEnvironment"); e.image=image_of("Studio", studio(), True)
    bg = t.nodes.get("Background") or t.nodes.new("ShaderNodeBackground")
    out = t.nodes.get("World Output") or t.nodes.new("ShaderNodeOutputWorld")
    t.links.new(e.outputs[0], bg.inputs[0]); t.links.new(bg.outputs[0], out.inputs[0]); bg.inputs[1].default_value=float(E("WS","1"))
    cam = bpy.data.cameras.new("Camera"); co = bpy.data.objects.new("Camera",cam); sc.collection.objects.link(co); sc.camera=co
    eye, target = Vector(v("EYE","1.2,-13,3.6")), Vector(v("AT","0,0,1.75"))
    co.location=eye; co.rotation_euler=(target-eye).to_track_quat("-Z","Y").to_euler(); cam.lens=float(E("LENS","48"))
    r=sc.render; r.engine=E("ENG","CONIC"); r.resolution_x,r.resolution_y=a.size; r.filepath=os.path.abspath(a.output); r.image_settings.file_format="PNG"
    sc.view_settings.view_transform=E("VT","Standard"); sc.conic.samples=a.samples; sc.conic.max_depth=10
    if E("LOOK"): sc.view_settings.look=E("LOOK")
    if E("EXP"): sc.view_settings.exposure=float(E("EXP"))
    print("built",time.time()-T, len(sc.objects)); T=time.time()
    bpy.ops.render.render(write_still=True); print("rendered",time.time()-T)

def cutaway(prot, P, D, off, ball_m, rod_m):
    style = E("STYLE","vdw")
    cols = {"A": rgb(E("CA","8fb8c9")), "B": rgb(E("CB","e0c39a"))}
    pm = {k: principled(f"Chain {k}", v, lift=float(E("LIFT",".08")), Roughness=float(E("PR",".5"))) for k,v in cols.items()}
    if style=="vdw":
        r = prot.radius(VAN_DER_WAALS_RADIUS)*.1
        near = P[:,1] < float(E("CUT","-99"))
        keep = ~near if E("CUT")!="none" else near|True
        for i in np.flatnonzero(keep): ball(ball_m, pm[prot.chain[i]], "P", P[i]+off, r[i])
        print("kept",keep.sum())
    else:
        for ch in "AB":
            p = P[(prot.chain==ch)&(prot.name=="CA")]+off
            rr=float(E("TUBE",".09"))
            for q in p: ball(ball_m, pm[ch], "P", q, rr)
            for q,s in zip(p[:-1],p[1:]): rod(rod_m, pm[ch], "P", q, s, rr)
main()
