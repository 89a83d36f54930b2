// A window that logs the keys that it receives, and starts a program that types into it: desk.exe LOG KILL COMMAND LINE...
//
// KILL is 0, or the milliseconds after the first key press at which the program is terminated. The log has a line for each event:
// `down VIRTUAL-KEY`, `up VIRTUAL-KEY`, `char CODE-POINT`, `killed`, `exited CODE`, each after the time in milliseconds. The window
// closes two seconds after the program has ended.
#define UNICODE
#define _UNICODE
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

enum { TIMER_WATCH = 1, TIMER_KILL, TIMER_CLOSE };

static FILE *out;
static DWORD start;
static int kill_after;
static int is_kill_set;
static HANDLE program;

static void note(const char *event, unsigned value) {
    fprintf(out, "%lu %s %u\n", GetTickCount() - start, event, value);
    fflush(out);
}

static void watch(HWND window) {
    DWORD code;
    if (WaitForSingleObject(program, 0) != WAIT_OBJECT_0 || !GetExitCodeProcess(program, &code)) return;
    KillTimer(window, TIMER_WATCH);
    note("exited", code);
    SetTimer(window, TIMER_CLOSE, 2000, NULL);
}

static LRESULT CALLBACK handle(HWND window, UINT message, WPARAM w, LPARAM l) {
    switch (message) {
    case WM_KEYDOWN:
    case WM_SYSKEYDOWN:
        note("down", (unsigned)w);
        if (kill_after > 0 && !is_kill_set) {
            is_kill_set = 1;
            SetTimer(window, TIMER_KILL, kill_after, NULL);
        }
        break;
    case WM_KEYUP:
    case WM_SYSKEYUP:
        note("up", (unsigned)w);
        break;
    case WM_CHAR:
        note("char", (unsigned)w);
        break;
    case WM_LBUTTONDOWN:
        note("down", VK_LBUTTON);
        break;
    case WM_LBUTTONUP:
        note("up", VK_LBUTTON);
        break;
    case WM_TIMER:
        if (w == TIMER_WATCH) watch(window);
        if (w == TIMER_CLOSE) PostQuitMessage(0);
        if (w == TIMER_KILL) {
            KillTimer(window, TIMER_KILL);
            TerminateProcess(program, 9);
            note("killed", 9);
        }
        break;
    }
    return DefWindowProcW(window, message, w, l);
}

static int start_program(int count, char **arguments) {
    char line[8192] = "";
    for (int i = 0; i < count; i++) {
        if (strlen(line) + strlen(arguments[i]) + 4 > sizeof line) return 0;
        sprintf(line + strlen(line), "%s\"%s\"", i > 0 ? " " : "", arguments[i]);
    }
    STARTUPINFOA startup = {sizeof startup};
    PROCESS_INFORMATION process;
    if (!CreateProcessA(NULL, line, NULL, NULL, TRUE, 0, NULL, NULL, &startup, &process)) return 0;
    program = process.hProcess;
    return 1;
}

int main(int count, char **arguments) {
    if (count < 4 || !(out = fopen(arguments[1], "w"))) return 2;
    kill_after = atoi(arguments[2]);
    start = GetTickCount();
    WNDCLASSW class = {0};
    class.lpfnWndProc = handle;
    class.hInstance = GetModuleHandleW(NULL);
    class.lpszClassName = L"desk";
    RegisterClassW(&class);
    HWND window = CreateWindowExW(WS_EX_TOPMOST, L"desk", L"Desk", WS_OVERLAPPEDWINDOW | WS_VISIBLE, 100, 100, 600, 400,
                                  NULL, NULL, class.hInstance, NULL);
    SetForegroundWindow(window);
    SetFocus(window);
    if (GetForegroundWindow() != window || !start_program(count - 3, arguments + 3)) return 3;
    SetTimer(window, TIMER_WATCH, 20, NULL);
    MSG message;
    while (GetMessageW(&message, NULL, 0, 0) > 0) {
        TranslateMessage(&message);
        DispatchMessageW(&message);
    }
    fclose(out);
    return 0;
}
