// SPDX-License-Identifier: Apache-2.0
// Comes before the header of fmt 9 of the same name, and adds one declaration: the library contains the
// formatting code. spdlog calls vformat_to(), a template, so without this each file that logs compiles it
// again (3 s). g++ only: clang mangles the function's name differently from the library, which g++ compiled.
#pragma once

#include_next <fmt/format.h>

#if FMT_VERSION >= 90000 && FMT_VERSION < 100000 && !defined(FMT_HEADER_ONLY) && !defined(__clang__)
extern template void fmt::detail::vformat_to<char>(buffer<char>&, basic_string_view<char>,
                                                   basic_format_args<buffer_context<char>>, locale_ref);
#endif
