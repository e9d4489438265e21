// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

/// Files that cmake/embed.cmake builds into the library, so that a report needs none at run time.
namespace impactrig::reports::embedded {

struct EmbeddedFile {
  std::string_view name;
  std::string_view bytes;
  std::string_view sha256;
};

extern const EmbeddedFile campaign_css, campaign_html, campaign_js;    ///< of reports/page
extern const EmbeddedFile dygraph_min_css, dygraph_min_js;  ///< of libjs-dygraphs
extern const EmbeddedFile dygraphs_licence_txt;
extern const EmbeddedFile page_html, report_css, report_js;  ///< of reports/page

}  // namespace impactrig::reports::embedded
