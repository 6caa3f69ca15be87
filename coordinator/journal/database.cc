#include "coordinator/journal/database.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <utility>

#include "common/files/open_file.h"

namespace depthfarm {
namespace {

Status ErrorOf(sqlite3* database, int code, const std::string& path) {
  const int primary = code & 0xff;
  const std::string reason = database == nullptr ? sqlite3_errstr(code) : sqlite3_errmsg(database);
  if (primary == SQLITE_BUSY || primary == SQLITE_LOCKED)
    return Unavailable(path + ": another process uses it: end that one, or name another file");
  if (primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB) return Corrupt(path + ": " + reason);
  return Unavailable(path + ": " + reason);
}

}  // namespace

Statement::Statement(sqlite3* database, sqlite3_stmt* statement, int error, std::string path)
    : database_(database), statement_(statement), error_(error), path_(std::move(path)) {}

Statement::Statement(Statement&& other) noexcept
    : database_(other.database_),
      statement_(std::exchange(other.statement_, nullptr)),
      error_(other.error_),
      path_(std::move(other.path_)),
      bound_(other.bound_) {}

Statement::~Statement() { sqlite3_finalize(statement_); }

Statement& Statement::Bind(std::int64_t value) {
  if (error_ == SQLITE_OK) error_ = sqlite3_bind_int64(statement_, ++bound_, value);
  return *this;
}

Statement& Statement::BindText(std::string_view text) {
  if (error_ == SQLITE_OK)
    error_ = sqlite3_bind_text64(statement_, ++bound_, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  return *this;
}

Statement& Statement::BindBlob(std::string_view bytes) {
  if (error_ == SQLITE_OK)
    error_ = sqlite3_bind_blob64(statement_, ++bound_, bytes.data(), bytes.size(), SQLITE_TRANSIENT);
  return *this;
}

Status Statement::Run() {
  DEPTHFARM_ASSIGN_OR_RETURN(const bool row, Next());
  return row ? Internal(path_ + ": a statement that should have no rows has one") : Status();
}

Result<bool> Statement::Next() {
  if (error_ != SQLITE_OK) return ErrorOf(database_, error_, path_);
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  return ErrorOf(database_, code, path_);
}

std::int64_t Statement::Integer(int column) const { return sqlite3_column_int64(statement_, column); }

std::string Statement::Bytes(int column) const {
  const void* bytes = sqlite3_column_blob(statement_, column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), size);
}

Result<std::unique_ptr<Database>> Database::Open(const std::string& path, bool may_create, const std::string& vfs) {
  const std::string name = path.empty() ? "journal in memory" : path;
  if (!path.empty() && vfs.empty()) {
    // SQLite would make it readable for all. Paths and names of a studio's jobs are nobody else's business.
    const int file = open(path.c_str(), O_RDWR | O_CLOEXEC | (may_create ? O_CREAT : 0), 0600);
    if (file < 0) return FileFailure(path, may_create ? "open or make the journal" : "open the journal");
    close(file);
  }
  sqlite3* handle = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_FULLMUTEX | SQLITE_OPEN_EXRESCODE;
  const int code =
      sqlite3_open_v2(path.empty() ? ":memory:" : path.c_str(), &handle, flags, vfs.empty() ? nullptr : vfs.c_str());
  std::unique_ptr<Database> database(new Database(handle, name));
  if (code != SQLITE_OK) return ErrorOf(handle, code, name);
  // Exclusive before WAL: then no shared memory file is needed, and who opens it second is refused.
  DEPTHFARM_RETURN_IF_ERROR(
      database->Execute("PRAGMA locking_mode = EXCLUSIVE; PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;"
                        "BEGIN EXCLUSIVE; COMMIT;"));
  return database;
}

Database::~Database() { sqlite3_close_v2(database_); }

Status Database::Execute(const std::string& sql) {
  const int code = sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr);
  return code == SQLITE_OK ? Status() : ErrorOf(database_, code, path_);
}

Statement Database::Prepare(std::string_view sql) const {
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v2(database_, sql.data(), static_cast<int>(sql.size()), &statement, nullptr);
  return {database_, statement, code, path_};
}

Result<Transaction> Transaction::Begin(Database& database) {
  DEPTHFARM_RETURN_IF_ERROR(database.Execute("BEGIN IMMEDIATE"));
  return Transaction(&database);
}

Transaction::~Transaction() {
  if (database_ != nullptr) (void)database_->Execute("ROLLBACK");  // the journal stays as it was
}

Status Transaction::Commit() {
  DEPTHFARM_RETURN_IF_ERROR(database_->Execute("COMMIT"));
  database_ = nullptr;
  return {};
}

}  // namespace depthfarm
