// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/correlated_field.hpp"

#include <cstddef>
#include <limits>

namespace sonard::render {

FieldReader::FieldReader(const ReceiverTables& tables, const RandomFieldOfPing& field,
                         const SkipSwitches& skip, SkipCounts& skipped)
    : tables_(tables),
      field_(field),
      skip_(skip),
      skipped_(skipped),
      beams_(tables.filter.beams()),
      copies_(tables.filter.copies() && skip.on(SkipRule::narrow_aperture)),
      white_(tables.filter.row_width()),
      joined_(beams_) {
  const std::size_t rows = 2 * static_cast<std::size_t>(tables.pulse_correlation.reach()) + 1;
  const Drawn none{ComplexRow(copies_ ? tables.filter.row_width() : beams_),
                   std::numeric_limits<int>::min(),
                   {nullptr, nullptr}};
  drawn_.assign(rows, none);
  real_.resize(rows);
  imaginary_.resize(rows);
}

Phasors FieldReader::line(int bin) {
  if (field_.beam.real != nullptr) {
    return {field_.beam.real + bin, field_.beam.imaginary + bin};
  }
  const int reach = tables_.pulse_correlation.reach();
  if (reach == 0) {
    if (field_.kept != nullptr) {
      evolve(bin);
    }
    if (skips(SkipRule::long_lines)) {
      return row(bin);
    }
  }
  for (int j = -reach; j <= reach; ++j) {
    const Phasors one = row(bin + j);
    real_[static_cast<std::size_t>(j + reach)] = one.real;
    imaginary_[static_cast<std::size_t>(j + reach)] = one.imaginary;
  }
  tables_.pulse_correlation.apply(real_, beams_, joined_.real());
  tables_.pulse_correlation.apply(imaginary_, beams_, joined_.imaginary());
  return {joined_.real(), joined_.imaginary()};
}

void FieldReader::evolve(int bin) {
  if (!field_.kept->is_current(place(bin)) || !skips(SkipRule::unmoved_speckle)) {
    const Phasors fresh = draw(bin, drawn_[0].row);
    field_.kept->evolve(place(bin), fresh.real, fresh.imaginary);
  }
}

/// Counts too: to be asked only where the criterion of the rule is met.
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
  const BeamFilter& filter = tables_.filter;
  if (copies_) {
    skipped_.add(SkipRule::narrow_aperture);
    row.draw(field_.key, bin);
    return {filter.middle(row.real()), filter.middle(row.imaginary())};
  }
  white_.draw(field_.key, bin);
  row.filter(filter, white_);
  return {row.real(), row.imaginary()};
}

}  // namespace sonard::render
