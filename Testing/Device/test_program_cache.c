/* SPDX-License-Identifier: BSD-3-Clause
 * Built programs on disk: a second context loads what the first built, pictures are the same, and whatever is wrong with the folder or a
 * file in it costs the building only. */
#define _XOPEN_SOURCE 700
#include "remove_folder.h"
#include "small_scene.h"
#include "testing.h"

#include "device_state.h"
#include "program_cache.h"

#include <dirent.h>
#include <fcntl.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#define PATH 512

static char folder[PATH / 4]; /* of one case */
static const char* const source = "__kernel void fill(__global float* values) { values[get_global_id(0)] = NUMBER; }\n";

static int begin(void** state)
{
  (void)state;
  snprintf(folder, sizeof folder, "/tmp/stratus-programs-XXXXXX");
  return !mkdtemp(folder);
}

static int end(void** state)
{
  (void)state;
  stratus_program_limit(STRATUS_PROGRAMS_MOST);
  return remove_folder(folder);
}

static stratus_context* open_context(const char* programs)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  char message[1024];
  options.device = "0";
  options.program_folder = programs;
  if (stratus_context_create(&options, &context, message, sizeof message) != STRATUS_OK) {
    fail_msg("%s", message);
  }
  return context;
}

/* Runs the kernel of `number`, and checks what it wrote. Returns 1 if its program was loaded, 0 if it was built. */
static int run(const char* programs, const char* number)
{
  enum { COUNT = 64 };
  stratus_context* context = open_context(programs);
  stratus_program_statistics statistics;
  float values[COUNT] = { 0 };
  char defines[64];
  cl_kernel kernel;
  cl_mem buffer;
  const size_t global = COUNT, local = COUNT;
  snprintf(defines, sizeof defines, "-DNUMBER=%s", number);
  assert_int_equal(stratus_device_kernel_from(context, "fill", source, defines, "fill", &kernel), STRATUS_OK);
  assert_int_equal(stratus_device_buffer(context, CL_MEM_READ_WRITE, sizeof values, NULL, false, &buffer), STRATUS_OK);
  assert_int_equal(stratus_device_argument(context, kernel, 0, sizeof buffer, &buffer), STRATUS_OK);
  assert_int_equal(stratus_device_run(context, kernel, 1, &global, &local), STRATUS_OK);
  assert_int_equal(stratus_device_read(context, buffer, 0, sizeof values, values), STRATUS_OK);
  for (int i = 0; i < COUNT; ++i) {
    assert_true(values[i] == strtof(number, NULL));
  }
  assert_string_equal(stratus_context_message(context), "");
  stratus_device_buffer_release(buffer);
  stratus_context_get_programs(context, &statistics);
  assert_int_equal(statistics.built + statistics.loaded, 1);
  assert_true(statistics.built ? statistics.build_ms > 0.0 && statistics.load_ms == 0.0 : statistics.load_ms > 0.0);
  stratus_context_destroy(context);
  return (int)statistics.loaded;
}

/* Gives the path of the folder's only program; returns how many files there are. */
static int find_file(char path[PATH])
{
  DIR* entries = opendir(folder);
  int count = 0;
  assert_non_null(entries);
  for (const struct dirent* entry = readdir(entries); entry; entry = readdir(entries)) {
    if (entry->d_name[0] != '.') {
      snprintf(path, PATH, "%s/%.200s", folder, entry->d_name);
      ++count;
    }
  }
  closedir(entries);
  return count;
}

static size_t read_bytes(const char* path, unsigned char** bytes)
{
  struct stat status;
  FILE* file = fopen(path, "rb");
  assert_non_null(file);
  assert_int_equal(fstat(fileno(file), &status), 0);
  *bytes = malloc((size_t)status.st_size);
  assert_non_null(*bytes);
  assert_int_equal(fread(*bytes, 1, (size_t)status.st_size, file), (size_t)status.st_size);
  fclose(file);
  return (size_t)status.st_size;
}

static void write_bytes(const char* path, const void* bytes, size_t size)
{
  FILE* file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, size, file), size);
  assert_int_equal(fclose(file), 0);
  assert_int_equal(chmod(path, S_IRUSR | S_IWUSR), 0);
}

static void a_program_is_built_once_for_each_set_of_options(void** state)
{
  char path[PATH];
  (void)state;
  assert_int_equal(run(folder, "1.5f"), 0);
  assert_int_equal(run(folder, "1.5f"), 1);
  assert_int_equal(run(folder, "2.5f"), 0);
  assert_int_equal(find_file(path), 2);
  assert_int_equal(run(folder, "1.5f"), 1);
  assert_int_equal(run(folder, "2.5f"), 1);
  assert_int_equal(run("", "2.5f"), 0);
}

static void keys_differ_by_source_and_options(void** state)
{
  stratus_context* context = open_context("");
  const cl_device_id id = stratus_device_id(context->device);
  char key[STRATUS_PROGRAM_KEY], other[STRATUS_PROGRAM_KEY], name[128], driver[128];
  static char longest[STRATUS_PROGRAM_KEY];
  (void)state;
  assert_true(stratus_program_key(id, "source", "-DA=1", key));
  assert_true(stratus_program_key(id, "source", "-DA=1", other));
  assert_string_equal(key, other);
  assert_true(stratus_program_key(id, "source", "-DA=2", other));
  assert_string_not_equal(key, other);
  assert_true(stratus_program_key(id, "sourcf", "-DA=1", other));
  assert_string_not_equal(key, other);
  assert_true(stratus_program_key(id, "source ", "-DA=1", other));
  assert_string_not_equal(key, other);
  assert_int_equal(clGetDeviceInfo(id, CL_DEVICE_NAME, sizeof name, name, NULL), CL_SUCCESS);
  assert_int_equal(clGetDeviceInfo(id, CL_DRIVER_VERSION, sizeof driver, driver, NULL), CL_SUCCESS);
  assert_true(strstr(key, name) && strstr(key, driver));
  memset(longest, 'x', sizeof longest - 1);
  assert_false(stratus_program_key(id, "source", longest, key));
  stratus_context_destroy(context);
}

/* Every byte of the header and key, and bytes throughout the binary, are changed one at a time, and the file is cut there. */
static void a_damaged_file_is_built_anew_and_replaced(void** state)
{
  char path[PATH];
  unsigned char *bytes, *changed;
  (void)state;
  assert_int_equal(run(folder, "1.5f"), 0);
  assert_int_equal(find_file(path), 1);
  const size_t size = read_bytes(path, &bytes);
  changed = malloc(size + 1);
  assert_non_null(changed);
  stratus_context* context = open_context(folder);
  char key[STRATUS_PROGRAM_KEY];
  assert_true(stratus_program_key(stratus_device_id(context->device), source, "-cl-std=CL1.2 -DNUMBER=1.5f", key));
  int places = 0;
  for (size_t at = 0; at <= size; at += at < 600 ? 1 : size / 400 + 1) {
    void* binary;
    size_t found;
    for (int cut = 0; cut < 2; ++cut) {
      memcpy(changed, bytes, size);
      changed[size] = 0;
      if (!cut && at < size) {
        changed[at] ^= (unsigned char)(1u << at % 8);
      }
      const size_t kept = cut && at < size ? at : at == size ? size + 1 : size; /* at the end a byte is added */
      write_bytes(path, changed, kept);
      assert_int_equal(stratus_program_read(context, key, &binary, &found), STRATUS_OK);
      assert_null(binary);
      ++places;
    }
  }
  assert_true(places > 1000);
  stratus_context_destroy(context);
  for (size_t at = 0; at < size; at += size / 3) { /* and the whole sequence, kernel included */
    memcpy(changed, bytes, size);
    changed[at] ^= 1;
    write_bytes(path, changed, size);
    assert_int_equal(run(folder, "1.5f"), 0);
    assert_int_equal(run(folder, "1.5f"), 1);
  }
  assert_int_equal(find_file(path), 1);
  free(bytes);
  free(changed);
}

/* A file whose checksum fits, but which OpenCL cannot use. */
static void a_binary_that_opencl_refuses_is_built_anew(void** state)
{
  static const char nonsense[] = "this is no program";
  char key[STRATUS_PROGRAM_KEY];
  (void)state;
  stratus_context* context = open_context(folder);
  assert_true(stratus_program_key(stratus_device_id(context->device), source, "-cl-std=CL1.2 -DNUMBER=1.5f", key));
  void* binary;
  size_t size = 0;
  stratus_program_write(context, key, nonsense, sizeof nonsense);
  assert_int_equal(stratus_program_read(context, key, &binary, &size), STRATUS_OK);
  assert_int_equal(size, sizeof nonsense);
  assert_memory_equal(binary, nonsense, sizeof nonsense);
  stratus_release(context, binary);
  stratus_context_destroy(context);
  assert_int_equal(run(folder, "1.5f"), 0);
  assert_int_equal(run(folder, "1.5f"), 1);
}

static void files_that_others_may_write_links_and_pipes_are_not_read(void** state)
{
  char path[PATH], elsewhere[PATH];
  (void)state;
  assert_int_equal(run(folder, "1.5f"), 0);
  assert_int_equal(find_file(path), 1);
  assert_int_equal(chmod(path, S_IRUSR | S_IWUSR | S_IWGRP), 0);
  assert_int_equal(run(folder, "1.5f"), 0); /* and is replaced */
  assert_int_equal(run(folder, "1.5f"), 1);
  if (geteuid() == 0) { /* only root can give a file away */
    assert_int_equal(chown(path, 12345, 12345), 0);
    assert_int_equal(run(folder, "1.5f"), 0);
    assert_int_equal(run(folder, "1.5f"), 1);
  }
  snprintf(elsewhere, sizeof elsewhere, "%.100s/elsewhere", folder);
  assert_int_equal(rename(path, elsewhere), 0);
  assert_int_equal(symlink(elsewhere, path), 0);
  assert_int_equal(run(folder, "1.5f"), 0);
  assert_int_equal(run(folder, "1.5f"), 1);
  assert_int_equal(unlink(path), 0);
  assert_int_equal(mkfifo(path, S_IRWXU), 0); /* who waits for it waits for ever */
  assert_int_equal(run(folder, "1.5f"), 0);
  assert_int_equal(run(folder, "1.5f"), 1);
  assert_int_equal(unlink(path), 0);
  assert_int_equal(mkdir(path, S_IRWXU), 0); /* nothing replaces a folder */
  assert_int_equal(run(folder, "1.5f"), 0);
  assert_int_equal(run(folder, "1.5f"), 0);
}

static void a_folder_that_cannot_be_used_costs_the_building_only(void** state)
{
  char path[PATH], deep[PATH];
  (void)state;
  snprintf(path, sizeof path, "%.100s/file", folder);
  write_bytes(path, "", 0);
  snprintf(deep, sizeof deep, "%.100s/file/below", folder);
  assert_int_equal(run(deep, "1.5f"), 0); /* nobody can make a folder below a file */
  assert_int_equal(run("/proc/self/nothing", "1.5f"), 0);
  snprintf(deep, sizeof deep, "%.100s/a/b", folder); /* it is made */
  assert_int_equal(run(deep, "1.5f"), 0);
  assert_int_equal(run(deep, "1.5f"), 1);
  assert_int_equal(chmod(deep, S_IRUSR | S_IXUSR), 0); /* programs in the folder can still be read */
  assert_int_equal(run(deep, "1.5f"), 1);
  assert_int_equal(run(deep, "2.5f"), 0);
  if (geteuid() != 0) { /* root writes anywhere */
    assert_int_equal(run(deep, "2.5f"), 0);
  }
  assert_int_equal(chmod(deep, S_IRWXU), 0);
  assert_int_equal(remove_folder(deep), 0); /* it vanished */
  assert_int_equal(run(deep, "1.5f"), 0);
  assert_int_equal(run(deep, "1.5f"), 1);
}

/* Files of this process end after 1000 bytes for a while, as on a full disk. */
static void a_full_disk_leaves_nothing(void** state)
{
  static const char binary[5000];
  char path[PATH], key[STRATUS_PROGRAM_KEY];
  struct rlimit old;
  (void)state;
  stratus_context* context = open_context(folder);
  assert_true(stratus_program_key(stratus_device_id(context->device), source, "", key));
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
  const struct rlimit small = { 1000, old.rlim_max };
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
  stratus_program_write(context, key, binary, sizeof binary);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
  signal(SIGXFSZ, handler);
  assert_int_equal(find_file(path), 0);
  stratus_program_write(context, key, binary, sizeof binary);
  assert_int_equal(find_file(path), 1);
  stratus_context_destroy(context);
}

/* All programs were used long ago. Clocks of files are coarse, so that what a test does in between may be of one time. */
static void age_all(void)
{
  const struct timespec old[2] = { { 1000, 0 }, { 1000, 0 } };
  DIR* entries = opendir(folder);
  assert_non_null(entries);
  for (const struct dirent* entry = readdir(entries); entry; entry = readdir(entries)) {
    assert_true(entry->d_name[0] == '.' || utimensat(dirfd(entries), entry->d_name, old, 0) == 0);
  }
  closedir(entries);
}

static void the_folder_keeps_what_was_used_last(void** state)
{
  char path[PATH];
  struct stat status;
  const struct timespec old[2] = { { 1000, 0 }, { 1000, 0 } };
  (void)state;
  assert_int_equal(run(folder, "1.5f"), 0);
  assert_int_equal(find_file(path), 1);
  assert_int_equal(stat(path, &status), 0);
  stratus_program_limit((size_t)status.st_size * 5 / 2); /* two fit, three do not */
  assert_int_equal(run(folder, "2.5f"), 0);
  assert_int_equal(find_file(path), 2);
  age_all();
  assert_int_equal(run(folder, "1.5f"), 1); /* used again, so that it is the later one */
  assert_int_equal(run(folder, "3.5f"), 0);
  assert_int_equal(find_file(path), 2);
  assert_int_equal(run(folder, "1.5f"), 1);
  assert_int_equal(run(folder, "3.5f"), 1);
  age_all();
  assert_int_equal(run(folder, "3.5f"), 1);
  assert_int_equal(run(folder, "2.5f"), 0);
  assert_int_equal(find_file(path), 2);
  assert_int_equal(run(folder, "3.5f"), 1);
  /* Half-written files are deleted once they are old; other files stay. */
  char half[PATH], fresh[PATH], other[PATH];
  snprintf(half, sizeof half, "%.100s/0.program.abcdef", folder);
  snprintf(fresh, sizeof fresh, "%.100s/1.program.abcdef", folder);
  snprintf(other, sizeof other, "%.100s/other.txt", folder);
  write_bytes(half, "half", 4);
  write_bytes(fresh, "half", 4);
  write_bytes(other, "text", 4);
  assert_int_equal(utimensat(AT_FDCWD, half, old, 0), 0);
  assert_int_equal(utimensat(AT_FDCWD, other, old, 0), 0);
  assert_int_equal(run(folder, "4.5f"), 0);
  assert_int_equal(access(half, F_OK), -1);
  assert_int_equal(access(fresh, F_OK), 0);
  assert_int_equal(access(other, F_OK), 0);
}

/* A process of the next case. */
static int work_often(const char* programs)
{
  static const char* const numbers[] = { "1.5f", "2.5f", "3.5f" };
  stratus_program_limit(1); /* each write removes what others wrote */
  for (int i = 0; i < 9; ++i) {
    (void)run(programs, numbers[i % 3]);
  }
  return 0;
}

static void processes_that_write_load_and_remove_at_once_all_have_their_program(void** state)
{
  enum { PROCESSES = 3 };
  pid_t children[PROCESSES];
  (void)state;
  assert_int_equal(setenv("STRATUS_TEST_PROGRAMS", folder, 1), 0);
  for (int c = 0; c < PROCESSES; ++c) {
    children[c] = fork();
    assert_true(children[c] >= 0);
    if (children[c] == 0) {
      execl(test_program(), test_program(), "test_program_cache", "--often", (char*)NULL);
      _exit(127);
    }
  }
  for (int c = 0; c < PROCESSES; ++c) {
    int status = -1;
    assert_int_equal(waitpid(children[c], &status, 0), children[c]);
    assert_int_equal(status, 0);
  }
}

static void pictures_of_loaded_programs_have_the_same_bits(void** state)
{
  static small_picture built, loaded;
  int programs = 0;
  (void)state;
  for (int pass = 0; pass < 2; ++pass) {
    small_scene scene;
    stratus_ray_caster* caster = NULL;
    stratus_program_statistics statistics;
    stratus_context* context = open_context(folder);
    small_scene_fill(&scene);
    assert_int_equal(small_scene_camera(context, &scene), STRATUS_OK);
    assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    assert_int_equal(small_render(caster, &scene, &scene.transfer, 1, pass ? &loaded : &built, NULL), STRATUS_OK);
    stratus_ray_caster_destroy(caster);
    stratus_context_get_programs(context, &statistics);
    programs = pass ? programs : (int)statistics.built;
    assert_true(programs > 0); /* the picture's program, and its structures' programs */
    assert_int_equal(statistics.built, pass ? 0 : programs);
    assert_int_equal(statistics.loaded, pass ? programs : 0);
    stratus_context_destroy(context);
  }
  assert_memory_equal(&built, &loaded, sizeof built);
}

/* PoCL keeps programs itself, so by default our cache keeps none for it. */
static void the_default_folder_is_the_cache_s_and_none_for_pocl(void** state)
{
  stratus_context* context = open_context("");
  const bool ours = !stratus_programs_are_kept(stratus_device_id(context->device));
  char programs[PATH];
  (void)state;
  stratus_context_destroy(context);
  snprintf(programs, sizeof programs, "%s/programs-1", folder);
  assert_int_equal(setenv("STRATUS_CACHE_DIR", folder, 1), 0);
  assert_int_equal(run(NULL, "1.5f"), 0);
  assert_int_equal(run(NULL, "1.5f"), ours);
  assert_int_equal(access(programs, F_OK), ours ? 0 : -1);
  assert_int_equal(run(programs, "1.5f"), ours);
  assert_int_equal(setenv("STRATUS_CACHE_DIR", "", 1), 0);
  assert_int_equal(run(NULL, "1.5f"), 0);
}

static void paths_that_are_too_long_are_refused(void** state)
{
  static char longest[2000];
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  char message[256];
  (void)state;
  memset(longest, 'x', sizeof longest - 1);
  options.device = "host";
  options.program_folder = longest;
  assert_int_equal(stratus_context_create(&options, &context, message, sizeof message), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(message, "1999"));
  longest[959] = '\0';
  assert_int_equal(stratus_context_create(&options, &context, message, sizeof message), STRATUS_OK);
  stratus_context_destroy(context);
}

int test_program_cache(void)
{
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  if (test_option("--often")) {
    return work_often(getenv("STRATUS_TEST_PROGRAMS"));
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(a_program_is_built_once_for_each_set_of_options, begin, end),
    cmocka_unit_test_setup_teardown(keys_differ_by_source_and_options, begin, end),
    cmocka_unit_test_setup_teardown(a_damaged_file_is_built_anew_and_replaced, begin, end),
    cmocka_unit_test_setup_teardown(a_binary_that_opencl_refuses_is_built_anew, begin, end),
    cmocka_unit_test_setup_teardown(files_that_others_may_write_links_and_pipes_are_not_read, begin, end),
    cmocka_unit_test_setup_teardown(a_folder_that_cannot_be_used_costs_the_building_only, begin, end),
    cmocka_unit_test_setup_teardown(a_full_disk_leaves_nothing, begin, end),
    cmocka_unit_test_setup_teardown(the_folder_keeps_what_was_used_last, begin, end),
    cmocka_unit_test_setup_teardown(processes_that_write_load_and_remove_at_once_all_have_their_program, begin, end),
    cmocka_unit_test_setup_teardown(pictures_of_loaded_programs_have_the_same_bits, begin, end),
    cmocka_unit_test_setup_teardown(the_default_folder_is_the_cache_s_and_none_for_pocl, begin, end),
    cmocka_unit_test_setup_teardown(paths_that_are_too_long_are_refused, begin, end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
