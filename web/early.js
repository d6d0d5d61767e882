// Runs before anything is painted: the reader's choice of light or dark, so that nothing flashes.
try {
  const theme = localStorage.getItem('gust-theme');
  if (theme === 'light' || theme === 'dark') document.documentElement.dataset.theme = theme;
} catch {
  // storage may be closed to files opened from disk
}
