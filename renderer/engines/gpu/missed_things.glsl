// SPDX-License-Identifier: Apache-2.0
// Thin things that a slice misses, and upright edges in its wedge, for refine.comp. As SliceCutter.

bool lies_well_inside(float offset_rad, Slice slice) {
  const float margin = 1e-3;  // of the wedge
  return abs(offset_rad - slice.offset_rad) < (0.5 - margin) * slice.width_rad;
}

// Height in t of the triangles of a thing that reach into the wedge of a slice.
float height_within(Slice slice, uint key) {
  float azimuth = of_beam.middle_rad + slice.offset_rad, low = never, high = -never;
  for (uint i = 0u; i < of_beam.things; i += things_a_round) {
    for (uint k = 0u; k < things_a_round; ++k) {
      Thing thing = things[of_beam.first_thing + min(i + k, of_beam.things - 1u)];
      if (thing.key == key && thing.low_azimuth < azimuth + 0.5 * slice.width_rad &&
          thing.high_azimuth > azimuth - 0.5 * slice.width_rad) {
        low = min(low, thing.low_t);
        high = max(high, thing.high_t);
      }
    }
  }
  return max(high - low, 0.0);
}

// As SliceCutter::missed_height().
float missed_height(Slice slice) {
  float azimuth = of_beam.middle_rad + slice.offset_rad, half_width = 0.5 * slice.width_rad, height = 0.0;
  uint measured = none;  // key of the last height, which all ends with this key have
  for (uint i = 0u; i < of_beam.ends; ++i) {
    ThingEnd end = ends[2u * of_beam.first_thing + i];
    float beside = end.azimuth - azimuth;
    bool is_low = (end.key & kind_mask) == low_kind;
    bool missed = is_low              ? lies_well_inside(end.azimuth - of_beam.middle_rad, slice)
                  : end.is_high != 0u ? beside < azimuth_error_rad && beside > -half_width
                                      : beside > -azimuth_error_rad && beside < half_width;
    if (missed) {
      height = max(height, least_missed);
    }
    if (missed && !is_low && end.key != measured) {
      height = max(height, height_within(slice, end.key));
      measured = end.key;
    }
  }
  return height;
}

// An upright edge, or the end of a low thing, in a slice.
struct SliceEdge {
  float offset_rad;
  uint edge;  // as Slice::edge; 0: the end of a low thing
};
const uint most_edges_of_slice = 4u;
struct SliceEdges {
  uint count;
  SliceEdge at[most_edges_of_slice];  // from port to starboard
};

uint probes_of(uint edge) {
  return edge == 0u ? 0u : edges[edge - 1u].count;
}

// An order that does not depend on where edges lie.
bool is_higher(SliceEdge a, SliceEdge b) {
  uint probes = probes_of(a.edge), other = probes_of(b.edge);
  return probes > other || (probes == other && a.offset_rad > b.offset_rad);
}

// Adds an edge; if there is no room, in the place of the lowest one.
void add_edge(SliceEdge edge, inout SliceEdges found) {
  uint at = found.count;
  if (at == most_edges_of_slice) {
    at = 0u;
    for (uint k = 1u; k < most_edges_of_slice; ++k) {
      at = is_higher(found.at[at], found.at[k]) ? k : at;
    }
    if (!is_higher(edge, found.at[at])) {
      return;
    }
  } else {
    ++found.count;
  }
  found.at[at] = edge;
}

void sort_edges(inout SliceEdges found) {
  for (uint k = 1u; k < found.count; ++k) {
    for (uint i = k; i > 0u && found.at[i - 1u].offset_rad < found.at[i].offset_rad; --i) {
      SliceEdge edge = found.at[i];
      found.at[i] = found.at[i - 1u];
      found.at[i - 1u] = edge;
    }
  }
}

// The highest edges well inside a slice (SliceCutter::find_upright_edges()).
SliceEdges edges_in(Slice slice) {
  SliceEdges found;
  found.count = 0u;
  for (uint i = 2u * of_beam.first_thing; i < 2u * of_beam.first_thing + of_beam.ends; ++i) {
    float offset_rad = ends[i].azimuth - of_beam.middle_rad;
    if ((ends[i].key & kind_mask) == low_kind && lies_well_inside(offset_rad, slice)) {
      add_edge(SliceEdge(offset_rad, 0u), found);
    }
  }
  for (uint i = of_beam.first_edge; i < of_beam.first_edge + of_beam.edges; ++i) {
    if (lies_well_inside(edges[i].offset_rad, slice)) {
      add_edge(SliceEdge(edges[i].offset_rad, i + 1u), found);
    }
  }
  sort_edges(found);
  return found;
}
