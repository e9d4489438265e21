// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "acquisition/importers/text_encoding.hpp"

namespace impactrig::acquisition {

/// True for a text whose lines stand in quotes as a whole, "Time;Force" and below it "0.001;2.5"
/// with them, as TranAX and spreadsheets that got a table into one column write them.
bool has_quoted_lines(std::string_view head);

/// Of such lines as another rewriting leaves them: blanks stand where their quotes stood, so that
/// places in a line stay what they are.
Rewriting without_quoted_lines(Rewriting of_bytes);

}  // namespace impactrig::acquisition
