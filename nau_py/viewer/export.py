"""The view as an element of a project file."""

from __future__ import annotations

from nau_py.viewer.controls import key_of
from nau_py.viewer.save import write_text
from nau_py.viewer.state import ViewerState


def camera_element(state: ViewerState) -> str:
    """Return the present camera as XML and YAML elements of a project file. Raises
    :class:`ValueError` if the pipeline names no camera."""
    name, pose = state.camera(), state.pose()
    values = {c.key: state.values.get(c.key, c.value) for c in state.controls()}
    projection = {
        component: write_text(value[0])
        for component in ("FOV", "NEAR", "FAR", "LEFT", "RIGHT", "BOTTOM", "TOP")
        if (value := values.get(key_of("CAMERA", name, component))) is not None
    }
    ortho = "LEFT" in projection
    kind = "ORTHO" if ortho else "PERSPECTIVE"
    vectors = {
        "POSITION": pose.position,
        "VIEW": pose.view,
        "UP": pose.up,
    }
    attributes = " ".join(f'{k}="{v}"' for k, v in ({"TYPE": kind} | projection).items())
    xml = [f'<camera name="{name}">', f"  <projection {attributes} />"]
    yaml = [f"- name: {name}", "  projection:", f"    TYPE: {kind}"]
    yaml += [f"    {k}: {v}" for k, v in projection.items()]
    for component, vector in vectors.items():
        x, y, z = (write_text(round(float(v), 5)) for v in vector)
        xml.append(f'  <{component} x="{x}" y="{y}" z="{z}" />')
        yaml.append(f"  {component}: [{x}, {y}, {z}]")
    return "\n".join([*xml, "</camera>", "", *yaml]) + "\n"
