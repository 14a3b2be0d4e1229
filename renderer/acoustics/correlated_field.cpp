// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/correlated_field.hpp"

#include <cstddef>
#include <limits>

namespace sonard::render {

Phasors correlate_along_range(const ComplexRow& white, int lines, const PulseCorrelation& along_range,
                              ComplexRow& out) {
  const int reach = along_range.reach();
  if (reach == 0) {
    return {white.real(), white.imaginary()};
  }
  out.ensure_width(lines);
  std::vector<const float*> real, imaginary;
  for (int j = 0; j <= 2 * reach; ++j) {
    real.push_back(white.real() + j);
    imaginary.push_back(white.imaginary() + j);
  }
  along_range.apply(real, lines, out.real());
  along_range.apply(imaginary, lines, out.imaginary());
  return {out.real(), out.imaginary()};
}

Phasors draw_along_range(RandomKey key, int lines, const PulseCorrelation& along_range, ComplexRow& white,
                         ComplexRow& out) {
  white.ensure_width(lines + 2 * along_range.reach());
  white.draw(key, 0);
  return correlate_along_range(white, lines, along_range, out);
}

FieldReader::FieldReader(const BeamFilter& filter, const PulseCorrelation& along_range,
                         const RandomFieldOfPing& field, const SkipSwitches& skip, SkipCounts& skipped)
    : filter_(filter),
      along_range_(along_range),
      field_(field),
      skip_(skip),
      skipped_(skipped),
      beams_(filter.beams()),
      copies_(filter.copies() && skip.on(SkipRule::narrow_aperture)),
      white_(filter.row_width()),
      joined_(beams_) {
  const std::size_t rows = 2 * static_cast<std::size_t>(along_range.reach()) + 1;
  const Drawn none{
      ComplexRow(copies_ ? filter.row_width() : beams_), std::numeric_limits<int>::min(), {nullptr, nullptr}};
  drawn_.assign(rows, none);
  real_.resize(rows);
  imaginary_.resize(rows);
}

Phasors FieldReader::line(int bin) {
  if (const std::optional<Phasors> one = unjoined(bin)) {
    return *one;
  }
  along_range_.apply(real_, beams_, joined_.real());
  along_range_.apply(imaginary_, beams_, joined_.imaginary());
  return {joined_.real(), joined_.imaginary()};
}

const float* FieldReader::real_line(int bin) {
  if (const std::optional<Phasors> one = unjoined(bin)) {
    return one->real;
  }
  along_range_.apply(real_, beams_, joined_.real());
  return joined_.real();
}

std::optional<Phasors> FieldReader::unjoined(int bin) {
  if (field_.beam.real != nullptr) {
    return Phasors{field_.beam.real + bin, field_.beam.imaginary + bin};
  }
  const int reach = along_range_.reach();
  if (reach == 0) {
    if (field_.kept != nullptr) {
      evolve(bin);
    }
    if (skips(SkipRule::long_bins)) {
      return row(bin);
    }
  }
  for (int j = -reach; j <= reach; ++j) {
    const Phasors one = row(bin + j);
    real_[static_cast<std::size_t>(j + reach)] = one.real;
    imaginary_[static_cast<std::size_t>(j + reach)] = one.imaginary;
  }
  return std::nullopt;
}

void FieldReader::evolve(int bin) {
  if (!field_.kept->is_current(place(bin)) || !skips(SkipRule::unmoved_speckle)) {
    const Phasors fresh = draw(bin, drawn_[0].row);
    field_.kept->evolve(place(bin), fresh.real, fresh.imaginary);
  }
}

/// Also counts the skip: call it only if the criterion of the rule is met.
bool FieldReader::skips(SkipRule rule) {
  const bool on = skip_.on(rule);
  skipped_.add(rule, on ? 1 : 0);
  return on;
}

Phasors FieldReader::row(int bin) {
  if (field_.kept != nullptr) {
    return {field_.kept->real(place(bin)), field_.kept->imaginary(place(bin))};
  }
  Drawn& drawn = drawn_[static_cast<std::size_t>(place(bin)) % drawn_.size()];
  if (drawn.bin != bin) {
    drawn.phasors = draw(bin, drawn.row);
    drawn.bin = bin;
  }
  return drawn.phasors;
}

Phasors FieldReader::draw(int bin, ComplexRow& row) {
  if (copies_) {
    skipped_.add(SkipRule::narrow_aperture);
    row.draw(field_.key, bin);
    return {filter_.middle(row.real()), filter_.middle(row.imaginary())};
  }
  white_.draw(field_.key, bin);
  row.filter(filter_, white_);
  return {row.real(), row.imaginary()};
}

}  // namespace sonard::render
