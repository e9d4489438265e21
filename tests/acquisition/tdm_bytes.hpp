// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "tests/acquisition/bytes.hpp"
#include "tests/acquisition/sigrok_bytes.hpp"

namespace impactrig::acquisition::tests {

/// A channel of a TDM description; texts go in as they are.
struct TdmChannel {
  std::string name = "F";
  std::string unit = "N";
  /// Attributes of its block in the file of samples; "": it has none. One with `blockSize` is of a
  /// record.
  std::string block = R"(byteOffset="0" length="3" valueType="eFloat64Usi")";
  std::string representation = "explicit";
  std::string parameters{};  ///< generation_parameters
  std::string attributes{};  ///< within instance_attributes
  std::string column{};      ///< further elements of the local column
  std::string says{};        ///< further elements of the channel
  int rows = 3;
  std::string values{};  ///< within <values>, where there is no block
};

/// A group and the file of samples it is in.
struct TdmGroup {
  std::string name = "G";
  std::vector<TdmChannel> channels{TdmChannel{}};
  std::string attributes{};
  std::string url = "shot.tdx";
  std::string byte_order = "littleEndian";
};

inline std::string tdm_reference(const std::string& element, const std::vector<std::string>& ids) {
  std::string list;
  for (const std::string& id : ids)
    list += fmt::format("{}id(\"{}\")", list.empty() ? "" : " ", id);
  return fmt::format("<{0}>#xpointer({1})</{0}>", element, list);
}

/// The elements of a channel; `id` makes its ids unique.
inline std::string tdm_channel_elements(const TdmChannel& channel, const std::string& id,
                                        const std::string& group) {
  const std::string sequence = channel.block.empty()
                                   ? fmt::format("<values>{}</values>", channel.values)
                                   : fmt::format("<values external=\"inc{}\"/>", id);
  std::string text =
      fmt::format("<double_sequence id=\"seq{}\">{}</double_sequence>", id, sequence);
  text += fmt::format("<tdm_channel id=\"ch{}\"><name>{}</name><unit_string>{}</unit_string>{}", id,
                      channel.name, channel.unit, channel.says);
  text += tdm_reference("group", {group});
  text += fmt::format("<instance_attributes>{}</instance_attributes>", channel.attributes);
  text += tdm_reference("local_columns", {"lc" + id}) + "</tdm_channel>";
  text += fmt::format(
      "<submatrix id=\"sm{}\"><name>Untitled</name><number_of_rows>{}"
      "</number_of_rows></submatrix>",
      id, channel.rows);
  text += fmt::format("<localcolumn id=\"lc{}\"><name>Untitled</name>", id);
  text += tdm_reference("measurement_quantity", {"ch" + id});
  text += tdm_reference("submatrix", {"sm" + id}) + "<global_flag>15</global_flag>";
  text +=
      fmt::format("<sequence_representation>{}</sequence_representation>", channel.representation);
  if (!channel.parameters.empty())
    text += fmt::format("<generation_parameters>{}</generation_parameters>", channel.parameters);
  return text + channel.column + tdm_reference("values", {"seq" + id}) + "</localcolumn>";
}

/// A description as DIAdem writes it. Blocks beside those of channels are in `blocks`, of the first
/// file; `root` goes into tdm_root.
inline std::string tdm_header(const std::vector<TdmGroup>& groups, const std::string& root = "",
                              const std::string& blocks = "") {
  std::string files, data, group_elements;
  std::vector<std::string> group_ids;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const TdmGroup& group = groups[g];
    files += fmt::format("<file byteOrder=\"{}\" url=\"{}\">{}", group.byte_order, group.url,
                         g == 0 ? blocks : "");
    std::vector<std::string> ids;
    group_ids.push_back(fmt::format("gr{}", g));
    for (std::size_t c = 0; c < group.channels.size(); ++c) {
      const TdmChannel& channel = group.channels[c];
      const std::string id = fmt::format("{}_{}", g, c);
      const bool in_records = channel.block.find("blockSize") != std::string::npos;
      if (!channel.block.empty())
        files += fmt::format("<{} id=\"inc{}\" {}/>", in_records ? "block_bm" : "block", id,
                             channel.block);
      ids.push_back("ch" + id);
      data += tdm_channel_elements(channel, id, group_ids.back());
    }
    files += "</file>";
    group_elements += fmt::format(
        "<tdm_channelgroup id=\"{}\"><name>{}</name>{}<instance_attributes>{}"
        "</instance_attributes>{}</tdm_channelgroup>",
        group_ids.back(), group.name, tdm_reference("root", {"root"}), group.attributes,
        tdm_reference("channels", ids));
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"no\" ?><usi:tdm "
         "xmlns:usi=\"http://www.ni.com/Schemas/USI/1_0\" version=\"1.0\"><usi:documentation>"
         "<usi:exporter>National Instruments USI</usi:exporter></usi:documentation><usi:include>" +
         files + "</usi:include><usi:data><tdm_root id=\"root\"><name>Shot 7</name>" + root +
         tdm_reference("channelgroups", group_ids) + "</tdm_root>" + group_elements + data +
         "</usi:data></usi:tdm>";
}

/// The same packed as by DIAdem 2020.
inline std::string packed_tdm(const std::string& header) {
  return zip_archive({{"header.xml", header, true}});
}

inline std::vector<std::string> tdm_seeds() {
  TdmChannel raw;
  raw.block = R"(byteOffset="0" blockOffset="2" blockSize="10" length="9" valueType="eInt16Usi")";
  raw.representation = "raw_linear";
  raw.parameters = "1 -0.5";
  raw.attributes = R"(<double_attribute name="wf_increment">1e-6</double_attribute>)";
  TdmChannel times{"Time", "s", R"(byteOffset="8" length="2" valueType="eFloat64Usi")",
                   "implicit_linear"};
  times.rows = 9;
  TdmChannel stamps{"Stamp", "", R"(byteOffset="64" length="9" valueType="eTimeUsi")"};
  TdmChannel marked;
  marked.block = R"(byteOffset="16" length="9" valueType="eUInt8Usi")";
  marked.column = "<flags external=\"mark\"/>";
  TdmChannel polynomial = marked;
  polynomial.representation = "raw_polynomial";
  polynomial.parameters = "2 1 0 3";
  const std::string marks =
      R"(<block id="mark" byteOffset="32" length="9" valueType="eInt16Usi"/>)";
  const std::string plain = tdm_header({{"G", {raw, times, marked}}, {"H", {stamps, polynomial}}},
                                       "<title>t</title>", marks);
  return {plain, packed_tdm(tdm_header({{"G", {raw, times}, "", "b.tdx", "bigEndian"}})),
          tdm_header({{}, {"H", {raw}, "", "other.tdx"}})};
}

}  // namespace impactrig::acquisition::tests
