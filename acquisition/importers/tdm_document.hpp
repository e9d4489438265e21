// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"

namespace impactrig::acquisition {

/// The description of an NI TDM recording (.tdm): XML that stands alone, or the entry header.xml of
/// a ZIP archive, as DIAdem has written it since 2020. Elements refer to each other by ids.
class TdmDocument {
 public:
  /// Throws datasets::InputError.
  explicit TdmDocument(const MappedFile& file);

  /// The children of usi:include and usi:data; nothing refers out of them.
  pugi::xml_node include() const { return include_; }

  pugi::xml_node data() const { return data_; }

  /// The element of that id; null where there is none.
  pugi::xml_node find(std::string_view id) const;

  /// The elements that #xpointer(id("usi1") id("usi2")) in `by` refers to, in that order.
  std::vector<pugi::xml_node> referred(pugi::xml_node by) const;

  /// The first of them; null where there is none.
  pugi::xml_node first_referred(pugi::xml_node by) const;

 private:
  void load(const MappedFile& file, std::string_view text);
  void learn_ids(pugi::xml_node of);

  pugi::xml_document document_;
  pugi::xml_node include_;
  pugi::xml_node data_;
  std::unordered_map<std::string_view, pugi::xml_node> by_id_;  // ids lie in document_
};

/// The text of an element, or an attribute, without blanks around it, as UTF-8; of a longer one the
/// first `most` bytes.
std::string tdm_text(pugi::xml_node of, std::size_t most = 4000);
std::string tdm_text(pugi::xml_attribute of);

/// The name of an element, likewise.
std::string tdm_name(pugi::xml_node of);

/// The names of the files of samples that a description states, each once, as they stand.
std::vector<std::string> urls_of_tdm(const TdmDocument& document);

/// A file of samples beside a description.
struct TdmSamples {
  std::string path;      ///< "": there is none
  bool as_named = true;  ///< false: by the description's own name
};

/// The file that the `url` of the description at `path` means. Its last part alone counts: what
/// lies in another folder is never read. Where there is none of that name, and `alone` says that no
/// other is named, the file with the description's own name and the ending .tdx.
TdmSamples samples_beside_tdm(const std::string& path, const std::string& url, bool alone);

}  // namespace impactrig::acquisition
