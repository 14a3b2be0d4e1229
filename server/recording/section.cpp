// SPDX-License-Identifier: Apache-2.0
#include "server/recording/section.hpp"

#include <cstdint>

namespace sonard::server {

RecordingConfig read_recording(YamlSection& section, const std::filesystem::path& folder) {
  RecordingConfig recording;
  section.introduce(
      "[logs.md](logs.md#5-recording) describes the formats, full disks, and the files that a killed daemon "
      "leaves.");
  section.require("directory", "a folder for the logs");
  section.path("directory", recording.directory, folder,
               "folder of the logs, created if missing; only one daemon at a time can use it");
  section.boolean("glf", recording.glf,
                  "writes a `.glf` for each head of a type that has this format ([logs.md](logs.md))");
  section.boolean("mcap", recording.mcap,
                  "writes one MCAP file with images, poses, and the bytes of both directions");
  section.boolean("mcap_wire_bytes", recording.mcap_wire_bytes,
                  "includes the bytes of both directions, which images and replay do not need");
  section.boolean("mcap_foxglove", recording.mcap_foxglove,
                  "also writes each ping as Foxglove shows it: picture, pose, points");
  section.choice("mcap_compression", recording.mcap_zstd, {{"none", false}, {"zstd", true}},
                 "compression of each chunk of the MCAP file (1 MiB or one second)");
  section.boolean("pcapng", recording.pcapng,
                  "writes one capture for Wireshark with the bytes of both directions");
  section.boolean("sonar", recording.sonar,
                  "writes a `.sonar` for each head of a type that has this format ([logs.md](logs.md))");
  if (!recording.glf && !recording.mcap && !recording.pcapng && !recording.sonar) {
    section.report("directory",
                   "no kind of log is selected (expected glf, mcap, pcapng or sonar to be true)");
  }
  std::uint64_t mebibytes = recording.rotate_bytes >> 20;
  section.integer("rotate_mib", mebibytes, 1, 1800,  // a .glf holds 1907 MiB, and another ping may follow
                  "size of a file at which sonard closes all files and begins new ones");
  recording.rotate_bytes = mebibytes << 20;
  section.duration("rotate_min", recording.rotate_after, Range::from(0.05, 10'080.0),
                   "time in minutes after which sonard closes all files and begins new ones");
  section.choice("zone", recording.zone, {{"utc", RecordingZone::utc}, {"local", RecordingZone::local}},
                 "time zone of times in a `.glf`, which does not state its zone, and in file names");
  section.choice("sync", recording.sync,
                 {{"never", RecordingSync::never},
                  {"on_close", RecordingSync::on_close},
                  {"every_second", RecordingSync::every_second}},
                 "when files are forced onto the disk, against power cuts");
  mebibytes = recording.queue_bytes >> 20;
  section.integer("queue_mib", mebibytes, 1, 16'384,
                  "maximum amount of data that waits to be written; more is dropped and counted");
  recording.queue_bytes = mebibytes << 20;
  section.duration("stop_deadline_s", recording.stop_deadline, Range::from(0.0, 3600.0),
                   "maximum wait for the disk when the daemon ends; the log names lost data");
  return recording;
}

}  // namespace sonard::server
