// Which axis of a file points up.
#pragma once

namespace mocaplm {

// automatic: what the format or skeleton says; z is turned to Y up by -90 degrees about x.
enum class UpAxis { automatic, y, z };

}  // namespace mocaplm
