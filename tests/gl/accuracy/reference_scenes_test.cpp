// SPDX-License-Identifier: Apache-2.0
// Scenes without a closed form, against the stored images of the oracle (tests/oracle/README.md).
#include "tests/bench/reference.hpp"
#include "tests/gl/accuracy/accuracy_case.hpp"

namespace sonard::test {
namespace {

class ReferenceAccuracy : public AccuracyTest {
 protected:
  void expect_oracle(const std::string& name) const {
    const Scene scene = make_scene(name);
    const auto reference = bench::find_reference(scene, SONARD_SOURCE_DIR "/tests/data/oracle");
    expect_within(targets(), measure(render(scene), reference.value().image), name);
  }
};

INSTANTIATE_TEST_SUITE_P(Accuracy, ReferenceAccuracy, all_cases(), case_name);

TEST_P(ReferenceAccuracy, Flat100k) {
  expect_oracle("flat100k");
}

TEST_P(ReferenceAccuracy, Swell100k) {
  expect_oracle("swell100k");
}

TEST_P(ReferenceAccuracy, Ripple100k) {
  expect_oracle("ripple100k");
}

TEST_P(ReferenceAccuracy, B3Cluster) {
  expect_oracle("b3_cluster");
}

}  // namespace
}  // namespace sonard::test
