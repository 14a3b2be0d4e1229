// Scenes without a closed form, against the stored images of the oracle (tests/oracle/README.md).
#include "tests/bench/reference.hpp"
#include "tests/gl/accuracy/accuracy_case.hpp"

namespace sonard::test {
namespace {

class ReferenceBins : public AccuracyTest {
 protected:
  ImageAccuracy against_oracle(const std::string& name) const {
    const Scene scene = make_scene(name);
    const auto reference = bench::find_reference(scene, SONARD_SOURCE_DIR "/tests/data/oracle");
    return measure(render(scene), reference.value().image);
  }
};
class ReferenceBeams : public ReferenceBins {};

INSTANTIATE_TEST_SUITE_P(Accuracy, ReferenceBins, all_cases(), case_name);
INSTANTIATE_TEST_SUITE_P(Accuracy, ReferenceBeams, ray_cases(), case_name);

TEST_P(ReferenceBins, Flat100k) {
  expect_bins(limits(), against_oracle("flat100k"), "flat100k");
}

TEST_P(ReferenceBins, Swell100k) {
  expect_bins(limits(), against_oracle("swell100k"), "swell100k");
}

TEST_P(ReferenceBins, Ripple100k) {
  expect_bins(limits(), against_oracle("ripple100k"), "ripple100k");
}

TEST_P(ReferenceBins, B3Cluster) {
  expect_bins(limits(), against_oracle("b3_cluster"), "b3_cluster");
}

TEST_P(ReferenceBeams, Flat100k) {
  expect_beams(limits(), against_oracle("flat100k"), "flat100k");
}

TEST_P(ReferenceBeams, Swell100k) {
  expect_beams(limits(), against_oracle("swell100k"), "swell100k");
}

TEST_P(ReferenceBeams, Ripple100k) {
  expect_beams(limits(), against_oracle("ripple100k"), "ripple100k");
}

TEST_P(ReferenceBeams, B3Cluster) {
  expect_beams(limits(), against_oracle("b3_cluster"), "b3_cluster");
}

}  // namespace
}  // namespace sonard::test
