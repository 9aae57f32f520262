"""An assembly as URDF, which PyBullet loads."""

from __future__ import annotations

from collections.abc import Iterator
from xml.sax.saxutils import quoteattr

from nxt_twin.world.assembly import Assembly, RigidLink, Shape, Vector


def robot_urdf(assembly: Assembly) -> str:
    """The text of the file.

    PyBullet refuses moments of inertia that no body has, such as those of a wheel with a gear train. The file
    gives the largest for all three; the engine then sets each.
    """
    lines = [line for link in assembly.links for line in (*_link(link), *_joint(link, assembly.links[0]))]
    return "\n".join((f"<robot name={quoteattr(assembly.name)}>", *lines, "</robot>"))


def _link(link: RigidLink) -> Iterator[str]:
    most = max(link.inertia_kg_m2)
    yield f"<link name={quoteattr(link.name)}>"
    yield (
        f'<inertial><origin xyz="{_numbers(link.centre_m)}"/><mass value="{link.mass_kg!r}"/>'
        f'<inertia ixx="{most!r}" iyy="{most!r}" izz="{most!r}" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    for n, shape in enumerate(link.shapes):
        body = f'<origin xyz="{_numbers(shape.at_m)}" rpy="{_numbers(shape.turned_rad)}"/>{_geometry(shape)}'
        if shape.solid:
            yield f"<collision>{body}</collision>"
        if shape.seen:
            colour = " ".join(repr(part) for part in shape.colour)
            paint = f'<material name="{link.name}-{n}"><color rgba="{colour}"/></material>'
            yield f"<visual>{body}{paint}</visual>"
    yield "</link>"


def _geometry(shape: Shape) -> str:
    match shape.kind:
        case "box":
            inside = f'<box size="{_numbers(shape.size_m)}"/>'
        case "cylinder":
            inside = f'<cylinder radius="{shape.size_m[0]!r}" length="{shape.size_m[1]!r}"/>'
        case "sphere":
            inside = f'<sphere radius="{shape.size_m[0]!r}"/>'
    return f"<geometry>{inside}</geometry>"


def _joint(link: RigidLink, base: RigidLink) -> Iterator[str]:
    joint = link.joint
    if joint is None:
        return
    turning = "continuous" if joint.limits is None else "revolute"
    kind = {"hinge": turning, "slide": "prismatic", "fixed": "fixed"}[joint.kind]
    low, high = joint.limits or (1.0, -1.0)  # in this order Bullet takes it for unlimited
    yield f'<joint name={quoteattr(link.name)} type="{kind}">'
    yield f'<origin xyz="{_numbers(joint.at_m)}"/><axis xyz="{_numbers(joint.axis)}"/>'
    yield f"<parent link={quoteattr(base.name)}/><child link={quoteattr(link.name)}/>"
    yield f'<limit lower="{low!r}" upper="{high!r}" effort="1e9" velocity="1e9"/></joint>'


def _numbers(values: Vector | tuple[float, ...]) -> str:
    return " ".join(repr(float(value)) for value in values)
