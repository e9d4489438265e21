// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "acquisition/conditioning/condition.hpp"
#include "acquisition/recording_reader.hpp"

namespace impactrig::acquisition {

/// Narrows a selection to the channels that the sensors need, and names these to the sensors as
/// condition() will find them among those alone. Where a sensor leaves its channel open, names one
/// that is not there, or there is no sensor, all are needed, as condition() must choose or
/// complain; nothing is changed then.
void narrow_to_sensors(const RecordingHead& head, Selection& wanted, SensorSet& sensors);

}  // namespace impactrig::acquisition
