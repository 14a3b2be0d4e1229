// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/view_layout.hpp"

#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/errors.hpp"

namespace sonard::render {
namespace {

SubView view_of(int columns, int rows) {
  SubView view;
  view.columns = columns;
  view.rows = rows;
  return view;
}

void expect_apart(const std::vector<SubView>& views, const ViewLayout& layout) {
  ASSERT_EQ(layout.places.size(), views.size());
  for (std::size_t a = 0; a < views.size(); ++a) {
    const ViewLayout::Place& p = layout.places[a];
    EXPECT_GE(p.layer, 0);
    EXPECT_LT(p.layer, layout.layers);
    EXPECT_LE(p.x + views[a].rows, layout.width);
    EXPECT_LE(p.y + views[a].columns, layout.height);
    for (std::size_t b = 0; b < a; ++b) {
      const ViewLayout::Place& q = layout.places[b];
      const bool apart = p.layer != q.layer || p.x + views[a].rows <= q.x || q.x + views[b].rows <= p.x ||
                         p.y + views[a].columns <= q.y || q.y + views[b].columns <= p.y;
      EXPECT_TRUE(apart) << a << " and " << b;
    }
  }
}

TEST(ViewLayout, NoTwoViewsShareAPixel) {
  std::mt19937 random(1);  // NOLINT(*-msc51-cpp): the same views each time
  for (int round = 0; round < 50; ++round) {
    std::vector<SubView> views;
    for (int i = 0; i < 1 + round; ++i) {
      views.push_back(view_of(1 + static_cast<int>(random() % 90), 1 + static_cast<int>(random() % 400)));
    }
    const ViewLayout layout = lay_out(views, 512);
    EXPECT_LE(layout.width, 512);
    EXPECT_LE(layout.height, 512);
    expect_apart(views, layout);
  }
}

TEST(ViewLayout, OneViewHasATextureOfItsSizeOnItsSide) {
  const ViewLayout layout = lay_out({view_of(30, 400)}, 512);
  EXPECT_EQ(layout.width, 400);
  EXPECT_EQ(layout.height, 30);
  EXPECT_EQ(layout.layers, 1);
}

TEST(ViewLayout, WhatDoesNotFitBesideGoesIntoAnotherLayer) {
  const std::vector<SubView> views(3, view_of(512, 512));
  const ViewLayout layout = lay_out(views, 512);
  EXPECT_EQ(layout.layers, 3);
  expect_apart(views, layout);
}

TEST(ViewLayout, LittleIsLeftEmptyBetweenAlikeViews) {
  const std::vector<SubView> views(60, view_of(20, 2048));
  const ViewLayout layout = lay_out(views, 16384);
  EXPECT_EQ(layout.layers, 1);
  EXPECT_LT(1.0 * layout.width * layout.height, 1.5 * 60 * 20 * 2048);
}

TEST(ViewLayout, AViewLargerThanATextureIsRefused) {
  EXPECT_THROW(lay_out({view_of(20, 513)}, 512), RequestError);
  EXPECT_THROW(lay_out({view_of(513, 20)}, 512), RequestError);
}

}  // namespace
}  // namespace sonard::render
