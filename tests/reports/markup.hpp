// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace impactrig::tests {

/// "" when `xml` is one well-formed element: every tag closed in order, attributes quoted and not
/// repeated, no bare & or <. Else what is wrong and where. Knows no DTD, CDATA or comment: SVG of
/// ours has none.
std::string markup_problem(std::string_view xml);

/// The same for HTML as our page writes it: void elements, attributes without a value, a doctype;
/// what is between <script> or <style> and its end is not looked at.
std::string html_problem(std::string_view html);

}  // namespace impactrig::tests
