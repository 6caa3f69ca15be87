#ifndef DEPTHFARM_COORDINATOR_JOURNAL_DATABASE_H_
#define DEPTHFARM_COORDINATOR_JOURNAL_DATABASE_H_

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"

struct sqlite3;
struct sqlite3_stmt;

namespace depthfarm {

// One SQL statement with its parameters. Errors are kept and come out of Run or Next: calls need no checks between.
class Statement {
 public:
  ~Statement();
  Statement(Statement&& other) noexcept;
  Statement& operator=(Statement&&) = delete;

  // Parameters in their order.
  Statement& Bind(std::int64_t value);
  Statement& BindText(std::string_view text);  // UTF-8 or any bytes
  Statement& BindBlob(std::string_view bytes);

  // Of a statement without rows.
  [[nodiscard]] Status Run();
  // True when there is a(nother) row.
  [[nodiscard]] Result<bool> Next();
  [[nodiscard]] std::int64_t Integer(int column) const;
  [[nodiscard]] std::string Bytes(int column) const;  // of text and blobs

 private:
  friend class Database;
  Statement(sqlite3* database, sqlite3_stmt* statement, int error, std::string path);

  sqlite3* database_;
  sqlite3_stmt* statement_;
  int error_;
  std::string path_;
  int bound_ = 0;
};

// An SQLite database that this process alone uses. Errors name the file: kUnavailable (no permission, disk full, in use
// by another process), kCorrupt (damaged, no database).
class Database {
 public:
  // Opens the file, or makes it if `may_create`, its owner's only (0600); an empty path: in memory. `vfs`: a registered
  // SQLite VFS that has the file, empty for the system's.
  [[nodiscard]] static Result<std::unique_ptr<Database>> Open(const std::string& path, bool may_create,
                                                              const std::string& vfs = {});
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // Statements without parameters or rows, separated by semicolons.
  [[nodiscard]] Status Execute(const std::string& sql);
  [[nodiscard]] Statement Prepare(std::string_view sql) const;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  Database(sqlite3* database, std::string path) : database_(database), path_(std::move(path)) {}

  sqlite3* database_;
  std::string path_;  // for messages
};

// Rolls back unless Commit was called.
class Transaction {
 public:
  [[nodiscard]] static Result<Transaction> Begin(Database& database);
  ~Transaction();
  Transaction(Transaction&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}
  Transaction& operator=(Transaction&&) = delete;
  [[nodiscard]] Status Commit();

 private:
  explicit Transaction(Database* database) : database_(database) {}
  Database* database_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_JOURNAL_DATABASE_H_
