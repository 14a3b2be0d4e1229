# SPDX-License-Identifier: Apache-2.0
"""Writes the SDF text of a world: models with one link, one visual for each mesh."""

_HEAD = """<?xml version="1.0"?>
<!-- Made by configs/worlds/generate. {about}
     Frame: x east, y north, z up, metres; the water surface is at z = 0. -->
<sdf version="1.9" xmlns:sonard="https://sonard.dev/sdf">
  <world name="{name}">
    <sonard:water_surface_z>0</sonard:water_surface_z>
"""


class World:
    def __init__(self, name, about):
        self._lines = [_HEAD.format(name=name, about=about).rstrip("\n")]

    def model(self, name, visuals, pose="0 0 0 0 0 0", static=True, scale=None, comment=None):
        """One body: `visuals` are (name, mesh file, acoustic material) and, where there is one, a normal map file.

        A material is a name, or (name, {attribute: value}) if some of its numbers differ from the table (docs/worlds.md)."""
        out = self._lines.append
        if comment:
            out(f"    <!-- {comment} -->")
        out(f'    <model name="{name}">')
        out(f"      <static>{'true' if static else 'false'}</static>")
        out(f"      <pose>{pose}</pose>")
        out('      <link name="link">')
        for visual, mesh, material, *normal_map in visuals:
            out(f'        <visual name="{visual}">')
            size = f"<scale>{scale}</scale>" if scale else ""
            out(f"          <geometry><mesh><uri>{mesh}</uri>{size}</mesh></geometry>")
            name, numbers = (material, {}) if isinstance(material, str) else material
            attributes = "".join(f' {key}="{value}"' for key, value in numbers.items())
            out(f"          <sonard:material{attributes}>{name}</sonard:material>")
            for file in normal_map:
                out(f"          <material><pbr><metal><normal_map>{file}</normal_map></metal></pbr></material>")
            out("        </visual>")
        out("      </link>")
        out("    </model>")

    def text(self):
        return "\n".join(self._lines + ["  </world>", "</sdf>", ""])
