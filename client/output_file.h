// Files that are whole or not there: OUT is written below a temporary name and renamed; what is spooled has no name at all.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace meshfront {

// What a writer appends its bytes to.
class ByteSink {
 public:
  virtual ~ByteSink() = default;
  virtual absl::Status Append(absl::string_view bytes) = 0;
  virtual const std::string& name() const = 0;  // for messages
};

// A file that is appended to through a buffer of fixed size and, when it is seekable, read back. Owns its descriptor. Every error
// is Internal with the name and what the system says ("OUT.ply can't be written: No space left on device").
class BufferedFile : public ByteSink {
 public:
  static constexpr size_t kBufferBytes = 64 << 10;

  BufferedFile(int descriptor, std::string name);
  ~BufferedFile() override;
  BufferedFile(const BufferedFile&) = delete;
  BufferedFile& operator=(const BufferedFile&) = delete;

  absl::Status Append(absl::string_view bytes) override;
  absl::Status Flush();
  // Reads exactly `count` bytes at `offset`. What was appended must have been flushed.
  absl::Status ReadAt(uint64_t offset, void* bytes, size_t count) const;
  // Flushes, brings a file to the disk, and gives the descriptor back to the system; later calls fail.
  absl::Status Close();
  uint64_t size() const { return size_; }
  const std::string& name() const override { return name_; }

 private:
  absl::Status WriteThrough(const char* bytes, size_t count);

  int descriptor_;
  std::string name_;
  std::string buffer_;
  uint64_t size_ = 0;
};

// A nameless file in the folder, gone when it is closed, however the process ends.
absl::StatusOr<std::unique_ptr<BufferedFile>> CreateSpoolFile(const std::string& folder);
// The folder that what becomes `path` is spooled in: its own, where there must be room anyway, or that for temporary files when
// it is "-", a device or a pipe.
std::string SpoolFolderFor(const std::string& path);

// One output file. Nothing at `path` changes before Commit; without Commit the temporary file is removed. `-` is standard
// output and a device or pipe are written as it comes. A symbolic link is followed, also to a
// file that is not there yet. A name that ends in ".gz" is compressed.
class OutputFile {
 public:
  static absl::StatusOr<std::unique_ptr<OutputFile>> Create(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  ByteSink& sink();
  // Brings what was appended to the disk: what may fail of Commit, but for the renaming. Commit does it where it was not done.
  absl::Status Finish();
  absl::Status Commit();

 private:
  class GzipSink;
  OutputFile(std::string path, std::string temporary, std::unique_ptr<BufferedFile> file);

  std::string path_, temporary_;  // temporary: empty when there is nothing to rename or remove
  std::unique_ptr<BufferedFile> file_;
  std::unique_ptr<GzipSink> gzip_;  // null when the file is not compressed
  bool is_finished_ = false;
};

// Writes a whole file the same way.
absl::Status WriteWholeFile(const std::string& path, absl::string_view bytes);
// An output and the flag that names it.
struct NamedOutput {
  std::string name, path;
};
// InvalidArgument when two of them are standard output or lead to the same file, by links or otherwise. A device or a pipe may
// be named twice; an empty path is none.
absl::Status CheckNoneCollide(const std::vector<NamedOutput>& outputs);
// OK when a file could be created at `path`: its folder exists and can be written, and it is no folder itself. For telling so
// before the work rather than after it. `-` is always OK.
absl::Status CheckCanBeCreated(const std::string& path);

}  // namespace meshfront
