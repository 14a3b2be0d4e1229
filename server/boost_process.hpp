// SPDX-License-Identifier: Apache-2.0
// Boost.Process v1. Its header moved in Boost 1.86.
#pragma once

#if __has_include(<boost/process/v1.hpp>)
#include <boost/process/v1.hpp>
#include <boost/process/v1/extend.hpp>
namespace sonard::server {
namespace process = boost::process::v1;
}
#else
#include <boost/process.hpp>
#include <boost/process/extend.hpp>
namespace sonard::server {
namespace process = boost::process;
}
#endif
