// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "acquisition/importers/column_heads.hpp"

/// Heads of tables that only one program or instrument writes. `filled`: which lines of the head
/// hold text.
namespace impactrig::acquisition {

/// Names and units of a Campbell Scientific TOA5 file, which have a line of the kind of their
/// values below; False for other files.
bool take_toa5(const TableLayout& layout, const std::vector<std::size_t>& filled,
               std::vector<std::string_view>& names, std::vector<std::string_view>& units,
               TableHead& head);

/// Columns of a Graphtec logger (GL series): names, with their units below or in the settings of
/// the amplifier above, where the signals' names are too. False for other files.
bool take_graphtec(const TableLayout& layout, const std::vector<std::size_t>& filled,
                   TableHead& head);

/// What a level stands for, and when the first was taken, in what a GW Instek GDS-1000 writes
/// beside "Mode,Detail": levels, 25 a division, about the middle of the record.
///
/// Source: GW Instek, GDS-1000B Series Programming Manual, :ACQuire<X>:MEMory?; the times that
/// files of the other mode state.
void take_instek_levels(TableHead& head);

/// Keys that stand beside the samples, of each table where several are side by side. Such tables
/// have a time and one trace, named by the key Source.
void take_keys_beside_rows(const TableLayout& layout, TableHead& head);

/// Names, start and interval of LabVIEW SignalExpress's text export, where each key stands on the
/// line above its values, one a channel: "channel names:", "start times:", "dt:", "data:". False
/// for other files.
bool take_keys_over_values(const TableLayout& layout, const std::vector<std::size_t>& filled,
                           TableHead& head);

/// What BIOPAC AcqKnowledge writes above a text export: the interval ("0.1 msec/sample"), how many
/// channels there are ("2 channels"), name and unit of each on lines of their own, and above the
/// rows their numbers and how many samples each has.
struct AcqKnowledgeHead {
  double interval = 0.0;  ///< [s]
  std::vector<ColumnHead> channels;
};

/// None of other lines.
std::optional<AcqKnowledgeHead> acqknowledge_head(const std::vector<std::string_view>& lines);

/// Interval, names and units of it, and the unit of the times where there are any. False for other
/// files.
bool take_acqknowledge(const TableLayout& layout, TableHead& head);

}  // namespace impactrig::acquisition
