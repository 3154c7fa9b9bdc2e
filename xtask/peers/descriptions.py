"""Poses and torques of robot descriptions, by Pinocchio and by MuJoCo, for `cargo xtask descriptions`.

The first argument is a file of JSON with all models and motions, the second one the file for the answers. With `--versions` alone it
says which packages are here. Meshes are never opened: their geoms become small spheres, and masses that MuJoCo works out from geoms are
taken out of the torques and named. Joints that follow others are moved by the equalities of MuJoCo's model, or by `<mimic>` of a URDF,
and what they load is added to the torque of the joint that they follow.
"""

import json
import math
import re
import sys
import xml.etree.ElementTree as ElementTree


def package(name):
    try:
        return __import__(name)
    except ImportError:
        return None


numpy = package("numpy")
pinocchio = package("pinocchio")
mujoco = package("mujoco")

# What a passive force has to be to count [N m], [N].
LEAST_FORCE = 1e-12
# Of a part in the place of one without a mass [kg], [kg m^2], until the model is compiled.
STAND_IN = 1.0
# More than what MuJoCo takes for no mass [kg].
NEARLY_NONE = 1e-14
MASSLESS = "mass and inertia of moving bodies"


class Refused(Exception):
    """Why a peer does not take a model."""


def parsed(text):
    """A document whose prefixes nobody declares: they become part of the names, as for the peers."""
    text = re.sub(r"(</?)([A-Za-z_][\w.-]*):(?=[A-Za-z_])", r"\1\2_", text)
    text = re.sub(r"(\s)(?!xmlns)([A-Za-z_][\w.-]*):([\w.-]+\s*=)", r"\1\2_\3", text)
    return ElementTree.fromstring(text)


def first_line(error):
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return " ".join(lines[:2])[:200] or type(error).__name__


# ---------------------------------------------------------------- followers


def stated_mimics(text):
    """Who follows whom in a URDF: follower, leader, multiplier, offset."""
    found = []
    for joint in parsed(text).iter("joint"):
        mimic = joint.find("mimic")
        if mimic is None or joint.get("type") == "fixed":
            continue
        number = lambda key, default: float(mimic.get(key, default))
        found.append((joint.get("name"), mimic.get("joint"), number("multiplier", 1), number("offset", 0)))
    return found


class Ties:
    """Positions of all joints from those of the leaders, and torques the other way."""

    def __init__(self, ties):
        self.ties = {follower: (leader, multiplier, offset) for follower, leader, multiplier, offset in ties}

    def root(self, name):
        multiplier, offset = 1.0, 0.0
        for _ in range(64):
            if name not in self.ties:
                return name, multiplier, offset
            leader, own, shift = self.ties[name]
            offset += multiplier * shift
            multiplier *= own
            name = leader
        raise Refused("a joint follows itself")

    def value(self, name, values, is_position):
        root, multiplier, offset = self.root(name)
        if root not in values:
            return None
        return multiplier * values[root] + (offset if is_position else 0.0)


# ---------------------------------------------------------------- Pinocchio


def by_pinocchio(model):
    text = model["text"]
    try:
        tree = pinocchio.buildModelFromXML(text)
    except Exception as error:
        raise Refused(first_line(error)) from error
    tree.gravity.linear = numpy.array(model["gravity"])
    tree.gravity.angular = numpy.zeros(3)
    ties = Ties(stated_mimics(text))
    data = tree.createData()
    numbers = list(range(1, tree.njoints))
    frames = [frame(tree, tip) for tip in model["tips"]]
    base = None if model["base"] is None else frame(tree, model["base"])
    for name in model["joints"]:
        if not tree.existJointName(name):
            raise Refused(f"there is no joint `{name}`")
    answer = {"poses": [], "still": [], "moving": []}

    def vectors(motion):
        values = [dict(zip(model["joints"], motion[key])) for key in ("q", "dq", "ddq")]
        q, dq, ddq = pinocchio.neutral(tree), numpy.zeros(tree.nv), numpy.zeros(tree.nv)
        for number in numbers:
            joint, name = tree.joints[number], tree.names[number]
            own = [ties.value(name, by, key == 0) for key, by in enumerate(values)]
            if own[0] is None or joint.nv != 1:
                continue
            if joint.nq == 1:
                q[joint.idx_q] = own[0]
            else:
                q[joint.idx_q : joint.idx_q + 2] = numpy.cos(own[0]), numpy.sin(own[0])
            dq[joint.idx_v], ddq[joint.idx_v] = own[1], own[2]
        return q, dq, ddq

    def reduced(torques):
        out = dict.fromkeys(model["joints"], 0.0)
        for number in numbers:
            joint, name = tree.joints[number], tree.names[number]
            root, multiplier, _ = ties.root(name)
            if root in out and joint.nv == 1:
                out[root] += multiplier * torques[joint.idx_v]
        return [out[name] for name in model["joints"]]

    viscous = getattr(tree, "damping", numpy.zeros(tree.nv))
    dry = getattr(tree, "friction", numpy.zeros(tree.nv))
    dry = getattr(tree, "upperDryFrictionLimit", dry)
    for motion in model["motions"]:
        q, dq, ddq = vectors(motion)
        pinocchio.framesForwardKinematics(tree, data, q)
        start = pinocchio.SE3.Identity() if base is None else data.oMf[base]
        places = [start.inverse() * data.oMf[own] for own in frames]
        answer["poses"].append([[*place.translation, *place.rotation.flatten()] for place in places])
        still = numpy.zeros(tree.nv)
        answer["still"].append(reduced(pinocchio.rnea(tree, data, q, still, still)))
        rubbed = numpy.array(viscous) * dq + numpy.array(dry) * numpy.sign(dq)
        answer["moving"].append(reduced(pinocchio.rnea(tree, data, q, dq, ddq) + rubbed))
    return answer


def frame(tree, name):
    if tree.existBodyName(name):
        return tree.getBodyId(name)
    if tree.existFrame(name):
        return tree.getFrameId(name)
    raise Refused(f"there is no link `{name}`")


# ---------------------------------------------------------------- MuJoCo


def plain_urdf(text):
    """A URDF as MuJoCo reads it without meshes, its fixed links kept."""
    root = parsed(text)
    for link in root.iter("link"):
        for tag in ("visual", "collision"):
            for own in link.findall(tag):
                link.remove(own)
    for own in root.findall("mujoco"):
        root.remove(own)
    extension = ElementTree.SubElement(root, "mujoco")
    ElementTree.SubElement(extension, "compiler", {"fusestatic": "false", "balanceinertia": "false"})
    return ElementTree.tostring(root, encoding="unicode")


def specification(model):
    if model["kind"] == "urdf":
        return mujoco.MjSpec.from_string(plain_urdf(model["text"]))
    if model["path"] is not None:
        return mujoco.MjSpec.from_file(model["path"])
    return mujoco.MjSpec.from_string(model["text"])


def without_meshes(spec):
    for geom in spec.geoms:
        if geom.type in (mujoco.mjtGeom.mjGEOM_MESH, mujoco.mjtGeom.mjGEOM_HFIELD, mujoco.mjtGeom.mjGEOM_SDF):
            geom.type, geom.meshname, geom.hfieldname = mujoco.mjtGeom.mjGEOM_SPHERE, "", ""
            geom.size = [0.01, 0, 0]
        geom.meshname = ""
        geom.material = ""
    for site in spec.sites:
        site.material = ""
    for tendon in spec.tendons:
        tendon.material = ""
    for own in [*spec.skins, *spec.meshes, *spec.hfields, *spec.materials, *spec.textures]:
        spec.delete(own)
    for own in [*spec.keys, *spec.sensors]:
        spec.delete(own)


def compiled(model):
    """A model, and numbers of the bodies whose masses nobody states."""
    spec = specification(model)
    without_meshes(spec)
    said = []
    if spec.compiler.inertiafromgeom == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE:
        spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_AUTO
        said.append("inertiafromgeom")
    unstated, massless = [], []
    for body in spec.bodies:
        if body.name == "world" and body.parent is None:
            continue
        geoms = len(body.geoms) > 0
        if body.explicitinertial:
            continue
        (unstated if geoms else massless).append(body)
    if unstated and spec.compiler.settotalmass > 0:
        spec.compiler.settotalmass = -1
        said.append("settotalmass")
    try:
        tree = spec.compile()
    except Exception as error:
        if MASSLESS not in str(error):
            raise
        stated = [body for body in spec.bodies if body.explicitinertial and body.mass == 0.0]
        for body in stated:
            # a rotor whose mass is counted elsewhere keeps its inertia
            if any(body.inertia) or any(body.fullinertia[1:]) or body.fullinertia[0] > 0.0:
                body.mass = NEARLY_NONE
            else:
                massless.append(body)
        for body in massless:
            body.mass, body.inertia, body.explicitinertial = STAND_IN, [STAND_IN] * 3, True
            body.fullinertia = [math.nan] + [0.0] * 5
        tree = spec.compile()
        for body in massless:
            weigh_nothing(tree, body.id)
    of_geoms = [body.id for body in unstated if tree.body_mass[body.id] > 0.0]
    for body in of_geoms:
        weigh_nothing(tree, body)
    return tree, of_geoms, said


def weigh_nothing(tree, body):
    tree.body_mass[body] = 0.0
    tree.body_inertia[body] = 0.0
    if tree.body_simple[body]:
        # MuJoCo has the inertia of such joints ready
        first = tree.body_dofadr[body]
        own = slice(first, first + tree.body_dofnum[body])
        tree.dof_M0[own] = tree.dof_armature[own]


def names(tree, kind, count, word):
    found = [mujoco.mj_id2name(tree, kind, number) for number in range(count)]
    taken = {name for name in found if name}
    for number, name in enumerate(found):
        if name:
            continue
        name = f"{word}{number + (1 if word == 'joint' else 0)}"
        while name in taken:
            name += "_"
        taken.add(name)
        found[number] = name
    return found


def equality_ties(tree, joints):
    """Joints that follow another one, and equalities that are something else."""
    ties, others = [], []
    joint_kind = int(mujoco.mjtEq.mjEQ_JOINT)
    for number in range(tree.neq):
        if not tree.eq_active0[number]:
            continue
        first, second = tree.eq_obj1id[number], tree.eq_obj2id[number]
        data = tree.eq_data[number]
        kind = int(tree.eq_type[number])
        if kind != joint_kind:
            others.append(mujoco.mjtEq(kind).name.removeprefix("mjEQ_").lower())
        elif second < 0 or any(data[2:5]):
            others.append(f"joint {joints[first]}")
        else:
            start = lambda joint: tree.qpos0[tree.jnt_qposadr[joint]]
            offset = start(first) + data[0] - data[1] * start(second)
            ties.append((joints[first], joints[second], data[1], offset))
    return ties, others


def by_mujoco(model):
    try:
        tree, of_geoms, changed = compiled(model)
    except Refused:
        raise
    except Exception as error:
        raise Refused(first_line(error)) from error
    loads = {
        "tendon armature": tree.tendon_armature,
        "tendon friction": tree.tendon_frictionloss,
        "actuator armature": tree.actuator_armature,
        "actuator damping": tree.actuator_damping,
    }
    features = [{"kind": key, "size": 1.0} for key, own in loads.items() if numpy.any(own > 0)]
    # inertias of what is no body are taken out
    for own in (tree.tendon_armature, tree.actuator_armature):
        own[:] = 0.0
    tree.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    if model["kind"] == "urdf":
        tree.opt.gravity[:] = model["gravity"]
    data = mujoco.MjData(tree)
    joints = names(tree, mujoco.mjtObj.mjOBJ_JOINT, tree.njnt, "joint")
    bodies = names(tree, mujoco.mjtObj.mjOBJ_BODY, tree.nbody, "body")
    ties, others = equality_ties(tree, joints)
    if model["kind"] == "urdf" and not ties:
        ties = stated_mimics(model["text"])
    ties = Ties(ties)
    for name in model["joints"]:
        if name not in joints:
            raise Refused(f"there is no joint `{name}`")
    kinds = {int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)}
    single = [
        (number, name)
        for number, name in enumerate(joints)
        if int(tree.jnt_type[number]) in kinds
    ]
    answer = {"poses": [], "still": [], "moving": []}
    tips = [place(tree, bodies, tip, model) for tip in model["tips"]]
    base = None if model["base"] is None else place(tree, bodies, model["base"], model)
    passive = {"springs": 0.0, "damping": 0.0, "gravcomp": 0.0, "fluid": 0.0}

    def reduced(torques):
        out = dict.fromkeys(model["joints"], 0.0)
        for number, name in single:
            root, multiplier, _ = ties.root(name)
            if root in out:
                out[root] += multiplier * torques[tree.jnt_dofadr[number]]
        return [out[name] for name in model["joints"]]

    def largest(torques):
        return max((abs(own) for own in reduced(torques)), default=0.0)

    def torques(motion, is_moving):
        mujoco.mj_resetData(tree, data)
        values = [dict(zip(model["joints"], motion[key])) for key in ("q", "dq", "ddq")]
        for number, name in single:
            own = [ties.value(name, by, key == 0) for key, by in enumerate(values)]
            if own[0] is None:
                continue
            data.qpos[tree.jnt_qposadr[number]] = own[0]
            if is_moving:
                data.qvel[tree.jnt_dofadr[number]], data.qacc[tree.jnt_dofadr[number]] = own[1], own[2]
        mujoco.mj_inverse(tree, data)
        rubbed = tree.dof_damping * data.qvel + tree.dof_frictionloss * numpy.sign(data.qvel)
        if is_moving:
            note = {
                "springs": data.qfrc_spring,
                "damping": data.qfrc_damper + tree.dof_damping * data.qvel,
                "gravcomp": data.qfrc_gravcomp,
                "fluid": data.qfrc_fluid,
            }
            for key, own in note.items():
                passive[key] = max(passive[key], largest(own))
        return reduced(data.qfrc_inverse + data.qfrc_passive + rubbed)

    for motion in model["motions"]:
        answer["still"].append(torques(motion, False))
        answer["moving"].append(torques(motion, True))
        answer["poses"].append([relative(data, base, tip) for tip in tips])
    features += [{"kind": key, "size": own} for key, own in passive.items() if own > LEAST_FORCE]
    features += [{"kind": "geoms", "size": float(len(of_geoms))}] if moved(tree, of_geoms) else []
    features += [{"kind": key, "size": 1.0} for key in changed]
    features += [{"kind": f"equality {own}", "size": 1.0} for own in sorted(set(others))]
    return answer | {"features": features}


def moved(tree, bodies):
    """Those bodies that move with respect to the world."""
    return [body for body in bodies if tree.body_weldid[body] != 0]


def place(tree, bodies, name, model):
    if name in bodies:
        return ("body", bodies.index(name))
    site = mujoco.mj_name2id(tree, mujoco.mjtObj.mjOBJ_SITE, name)
    if site >= 0:
        return ("site", site)
    if model["kind"] == "urdf" and name == model["root"]:
        return ("body", 0)
    raise Refused(f"there is no body or site `{name}`")


def relative(data, base, tip):
    def of(own):
        kind, number = own
        position, rotation = (data.xpos, data.xmat) if kind == "body" else (data.site_xpos, data.site_xmat)
        return position[number], rotation[number].reshape(3, 3)

    position, rotation = of(tip)
    if base is not None:
        start, turn = of(base)
        position, rotation = turn.T @ (position - start), turn.T @ rotation
    return [*position, *rotation.flatten()]


# ---------------------------------------------------------------- request


def answered(model, peer):
    law = {"pinocchio": by_pinocchio, "mujoco": by_mujoco}[peer]
    try:
        return {"peer": peer} | law(model)
    except Refused as why:
        return {"peer": peer, "refused": str(why)}
    except Exception as error:  # a peer's own fault ends no job
        return {"peer": peer, "refused": f"{type(error).__name__}: {first_line(error)}"}


def plain(value):
    if isinstance(value, numpy.generic):
        return value.item()
    raise TypeError(type(value).__name__)


def main():
    versions = {"pinocchio": getattr(pinocchio, "__version__", None), "mujoco": getattr(mujoco, "__version__", None)}
    if "--versions" in sys.argv:
        print(json.dumps(versions))
        return
    request = json.load(open(sys.argv[1], encoding="utf-8"))
    answers = []
    for model in request["models"]:
        answers.append({"answers": [answered(model, peer) for peer in model["peers"]]})
    with open(sys.argv[2], "w", encoding="utf-8") as out:
        json.dump(versions | {"models": answers}, out, default=plain)


main()
