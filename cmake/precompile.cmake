# impactrig_precompile(TARGET [HEADER...])
#
# The headers of others that nearly every file of the target takes, parsed once rather than in each
# file: a fifth of a build's time. Files include what they use all the same, which the preset
# sanitize shows, that takes none of these, and of headers all_verify_interface_header_sets.
function(impactrig_precompile target)
  target_precompile_headers(${target} PRIVATE
    <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits> <map> <memory> <numbers>
    <optional> <random> <set> <span> <stdexcept> <string> <string_view> <utility> <variant> <vector> ${ARGN})
endfunction()
